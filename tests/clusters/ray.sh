#!/bin/sh
# A Ray cluster of three nodes on this machine: a head, which does no jobs, and two nodes, with their files in one folder.
# It needs `ray` on the PATH, which comes with pip install 'mimoc[ray]'.
#
#   ray.sh start DIR [CPUS]   start it, with that many cores a node, and print its address; to use it then:
#                             export RAY_AUTH_MODE=token RAY_AUTH_TOKEN_PATH=DIR/token
#   ray.sh kill DIR NODE      end a node, n1 or n2, with SIGKILL, as a power cut would
#   ray.sh stop DIR           end all of it

set -eu
verb=$1
mkdir -p "$2"
dir=$(cd "$2" && pwd)
export RAY_USAGE_STATS_ENABLED=0 RAY_AUTH_MODE=token RAY_AUTH_TOKEN_PATH="$dir/token"
export RAY_raylet_start_wait_time_s=300  # A busy machine takes its time.

free_port() {
    python3 -c 'import socket; s = socket.socket(); s.bind(("", 0)); print(s.getsockname()[1])'
}

# Start a node in a process group of its own, whose number names it.
node() {
    name=$1
    shift
    setsid ray start --block --disable-usage-stats --object-store-memory=100000000 "$@" > "$dir/$name.log" 2>&1 &
    echo $! > "$dir/$name.pid"
}

start() {
    command -v ray >/dev/null || { echo "ray is missing; run: pip install 'mimoc[ray]'" >&2; exit 1; }
    (umask 077 && python3 -c 'import secrets; print(secrets.token_hex(32), end="")' > "$dir/token")
    rm -f "$dir"/*.log
    address=127.0.0.1:$(free_port)
    node head --head --node-ip-address=127.0.0.1 --port="${address#*:}" --num-cpus=0 --include-dashboard=false \
        --temp-dir="$dir/ray"
    up 1
    node n1 --address="$address" --node-ip-address=127.0.0.1 --num-cpus="$1"
    node n2 --address="$address" --node-ip-address=127.0.0.1 --num-cpus="$1"
    up 3
    echo "$address"
}

up() {
    for _ in $(seq 300); do
        [ "$(grep -ls 'Ray runtime started' "$dir"/*.log | wc -l)" = "$1" ] && return
        sleep 0.5
    done
    echo "Ray did not start; see the logs in $dir" >&2
    exit 1
}

case $verb in
start) start "${3:-1}" ;;
kill) kill -9 -- "-$(cat "$dir/$3.pid")" ;;
stop) for each in n1 n2 head; do kill -- "-$(cat "$dir/$each.pid")" 2>/dev/null || true; done ;;
*) echo "what to do: start, kill or stop" >&2; exit 2 ;;
esac
