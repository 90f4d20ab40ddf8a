#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Submits a job script of Snakemake to Kubernetes and prints the job's name.
# usage: submit.sh CORES MEMORY_MB SCRIPT     (FARM_IMAGE: the image; default orchard-mapper:latest)
set -euo pipefail
name=orchard-$(sha256sum "$3" | cut -c1-12)-$RANDOM
mkdir -p work/kubernetes
cp "$3" "work/kubernetes/$name.sh" # a copy, because Snakemake removes the original
kubectl create -f - >&2 <<EOF
apiVersion: batch/v1
kind: Job
metadata: {name: $name}
spec:
  backoffLimit: 0
  ttlSecondsAfterFinished: 3600
  template:
    spec:
      restartPolicy: Never
      containers:
        - name: step
          image: ${FARM_IMAGE:-orchard-mapper:latest}
          workingDir: $PWD
          command: [bash, work/kubernetes/$name.sh]
          resources: {requests: {cpu: "$1", memory: ${2}Mi}, limits: {memory: ${2}Mi}}
          volumeMounts: [{name: farm, mountPath: $PWD}]
      volumes: [{name: farm, persistentVolumeClaim: {claimName: farm}}]
EOF
echo "$name"
