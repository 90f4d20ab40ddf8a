# SPDX-License-Identifier: BSD-3-Clause
# shellcheck shell=bash
# To be sourced: Slurm of one node and two queues, of Debian's slurmctld, slurmd and munge, in a
# private folder. It looks once a second whether a job has more memory than it asked for, and kills it:
# so do clusters without cgroups. Needs root, a private network namespace, and wait_until of season.sh.

has_slurm() {
  local program
  for program in slurmctld slurmd munged sbatch scontrol; do
    command -v $program >/dev/null || PATH=$PATH:/usr/sbin command -v $program >/dev/null || return 1
  done
  [ "$(id -u)" = 0 ]
}

# start_slurm FOLDER: sets SLURM_CONF, and slurm_pids for stop_slurm.
start_slurm() {
  local folder=$1 name
  name=$(hostname -s)
  ip addr add 10.77.0.1/32 dev lo 2>/dev/null # names are looked up only where there is more than 127.0.0.1
  mkdir -p "$folder"/{munge,state,spool}
  chmod 755 "$folder" "$folder/munge"
  (umask 077 && head -c 128 /dev/urandom >"$folder/munge/key")
  /usr/sbin/munged --foreground --force --key-file="$folder/munge/key" --socket="$folder/munge/socket" \
    --pid-file="$folder/munge/pid" --log-file="$folder/munge/log" --seed-file="$folder/munge/seed" \
    >"$folder/munge/said" 2>&1 &
  slurm_pids=($!)
  wait_until 20 test -S "$folder/munge/socket" || { cat "$folder/munge/said"; return 1; }
  cat >"$folder/slurm.conf" <<EOF
ClusterName=farm
SlurmctldHost=$name(10.77.0.1)
SlurmctldPort=16817
SlurmdPort=16818
SlurmUser=root
AuthType=auth/munge
AuthInfo=socket=$folder/munge/socket
CryptoType=crypto/munge
StateSaveLocation=$folder/state
SlurmdSpoolDir=$folder/spool
SlurmctldPidFile=$folder/slurmctld.pid
SlurmdPidFile=$folder/slurmd.pid
SlurmctldLogFile=$folder/slurmctld.log
SlurmdLogFile=$folder/slurmd.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/linux
JobAcctGatherParams=OverMemoryKill
JobAcctGatherFrequency=task=1
MpiDefault=none
ReturnToService=2
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU_Memory
SchedulerParameters=sched_interval=1,batch_sched_delay=1,sched_min_interval=100000
MinJobAge=600
NodeName=$name NodeAddr=10.77.0.1 CPUs=$(nproc) RealMemory=4000 State=UNKNOWN
PartitionName=short Nodes=$name MaxTime=10 Default=YES State=UP
PartitionName=long Nodes=$name MaxTime=UNLIMITED State=UP
EOF
  export SLURM_CONF=$folder/slurm.conf
  slurmctld -D >"$folder/slurmctld.said" 2>&1 &
  slurm_pids+=($!)
  slurmd -D >"$folder/slurmd.said" 2>&1 &
  slurm_pids+=($!)
  wait_until 60 eval 'sinfo -h -o %T 2>/dev/null | grep -q "^idle"' || {
    tail -n 20 "$folder"/slurm*.said "$folder"/slurm*.log
    return 1
  }
}

stop_slurm() {
  scancel --state=RUNNING --state=PENDING --user=root 2>/dev/null
  kill "${slurm_pids[@]}" 2>/dev/null
  wait "${slurm_pids[@]}" 2>/dev/null
  true
}
