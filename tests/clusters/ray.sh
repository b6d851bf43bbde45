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

free_port() {
    python3 -c 'import socket; s = socket.socket(); s.bind(("", 0)); print(s.getsockname()[1])'
}

# Start a node, in a process group of its own. Ray gives its agents 15 s to start, which is too little on a busy machine: so
# it is tried some times.
node() {
    name=$1
    shift
    for _ in 1 2 3 4 5 6; do
        setsid ray start --block --disable-usage-stats --object-store-memory=100000000 --include-log-monitor=false \
            --metrics-export-port="$(free_port)" --dashboard-agent-grpc-port="$(free_port)" \
            --dashboard-agent-listen-port="$(free_port)" --runtime-env-agent-port="$(free_port)" \
            "$@" > "$dir/$name.log" 2>&1 &
        group=$!
        echo $group > "$dir/$name.pid"
        while kill -0 $group 2>/dev/null; do
            grep -q 'Ray runtime started' "$dir/$name.log" && return
            sleep 0.5
        done
        kill -9 "-$group" 2>/dev/null || true
    done
    echo "Ray did not start; see the logs in $dir" >&2
    exit 1
}

start() {
    command -v ray >/dev/null || { echo "ray is missing; run: pip install 'mimoc[ray]'" >&2; exit 1; }
    (umask 077 && python3 -c 'import secrets; print(secrets.token_hex(32), end="")' > "$dir/token")
    port=$(free_port)
    node head --head --port="$port" --num-cpus=0 --include-dashboard=false --temp-dir="$dir/ray"
    address=$(sed -n "s/.*--address='\(.*\)'.*/\1/p" "$dir/head.log" | head -n 1)
    for each in n1 n2; do
        node "$each" --address="$address" --num-cpus="$1"
    done
    echo "$address"
}

case $verb in
start) start "${3:-1}" ;;
kill) kill -9 "-$(cat "$dir/$3.pid")" ;;
stop) for each in n1 n2 head; do kill -TERM "-$(cat "$dir/$each.pid")" 2>/dev/null || true; done ;;
*) echo "what to do: start, kill or stop" >&2; exit 2 ;;
esac
