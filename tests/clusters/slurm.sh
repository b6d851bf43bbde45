#!/bin/sh
# A SLURM of one controller and two nodes, n1 and n2, on this machine, with all its files in one folder.
# It needs Debian's packages slurm-wlm and munge.
#
#   slurm.sh start DIR [CPUS]   start it, with that many cores a node; then: export SLURM_CONF=DIR/slurm.conf
#   slurm.sh kill DIR NODE      end the daemon of a node and all its tasks with SIGKILL, as a power cut would
#   slurm.sh stop DIR           end all of it

set -eu
PATH="$PATH:/usr/sbin:/sbin"
verb=$1
mkdir -p "$2"
dir=$(cd "$2" && pwd)
export SLURM_CONF="$dir/slurm.conf"

free_port() {
    python3 -c 'import socket; s = socket.socket(); s.bind(("", 0)); print(s.getsockname()[1])'
}

configure() {
    mkdir -p "$dir/state" "$dir/n1" "$dir/n2"
    chmod 700 "$dir"
    host=$(hostname -s)
    cat > "$SLURM_CONF" <<END
ClusterName=mimoc
SlurmctldHost=$host(localhost)
SlurmUser=$(id -un)
SlurmdUser=$(id -un)
SlurmctldPort=$(free_port)
AuthType=auth/munge
AuthInfo=socket=$dir/munge.socket
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
ReturnToService=2
MpiDefault=none
StateSaveLocation=$dir/state
SlurmdSpoolDir=$dir/%n
SlurmctldPidFile=$dir/slurmctld.pid
SlurmdPidFile=$dir/%n.pid
SlurmctldLogFile=$dir/slurmctld.log
SlurmdLogFile=$dir/%n.log
SlurmdTimeout=10
KillWait=5
SchedulerParameters=sched_interval=5,batch_sched_delay=1
NodeName=n1 NodeHostname=$host NodeAddr=127.0.0.1 Port=$(free_port) CPUs=$1
NodeName=n2 NodeHostname=$host NodeAddr=127.0.0.1 Port=$(free_port) CPUs=$1
PartitionName=all Nodes=n1,n2 Default=YES MaxTime=60
END
}

start() {
    for each in munged slurmctld slurmd sbatch; do
        command -v $each >/dev/null || { echo "$each is missing (Debian: apt-get install slurm-wlm munge)" >&2; exit 1; }
    done
    configure "$1"
    head -c 64 /dev/urandom > "$dir/munge.key"
    chmod 400 "$dir/munge.key"
    munged --force --key-file="$dir/munge.key" --socket="$dir/munge.socket" --pid-file="$dir/munged.pid" \
        --log-file="$dir/munged.log" --seed-file="$dir/munged.seed"
    slurmctld
    slurmd -N n1
    slurmd -N n2
    for _ in $(seq 120); do
        [ "$(sinfo -h -N -o '%t' 2>/dev/null | grep -c '^idle$')" = 2 ] && return
        sleep 0.5
    done
    echo "SLURM did not start; see the logs in $dir" >&2
    exit 1
}

kill_node() {
    kill -9 "$(cat "$dir/$1.pid")"  # First, so that it does not tell how its tasks end.
    for each in $(ps -eo pid=,comm= | awk '$2 ~ /^slurmstepd/ {print $1}'); do
        ls -l "/proc/$each/fd" 2>/dev/null | grep -q "$dir/$1.log" && kill -9 $(family "$each") 2>/dev/null || true
    done
}

# A process and all that it has started.
family() {
    echo "$1"
    for each in $(ps -o pid= --ppid "$1"); do family "$each"; done
}

stop() {
    scancel --quiet --user="$(id -un)" 2>/dev/null || true
    for each in n1 n2 slurmctld munged; do
        [ -f "$dir/$each.pid" ] && kill "$(cat "$dir/$each.pid")" 2>/dev/null || true
    done
}

case $verb in
start) start "${3:-1}" ;;
kill) kill_node "$3" ;;
stop) stop ;;
*) echo "what to do: start, kill or stop" >&2; exit 2 ;;
esac
