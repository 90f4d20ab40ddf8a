#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Reports the state of a job to Snakemake: running, success or failed.
# usage: status.sh JOB
said=$(kubectl get job "$1" -o 'jsonpath={.status.succeeded}/{.status.failed}' 2>&1) || case $said in
  *NotFound*) echo failed; exit 0 ;;
  *) echo running; exit 0 ;;
esac
case $said in 1/*) echo success ;; */[1-9]*) echo failed ;; *) echo running ;; esac
