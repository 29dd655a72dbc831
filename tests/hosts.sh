#!/bin/bash
# A collapse over two hosts, one of which dies in the middle; then the run goes on from its last restart file on the other.
# The hosts are two network namespaces of this machine, with a cable between them (veth), so this needs root; without it
# the script says so and skips (status 77). Not one of ctest's tests.
#
#   tests/hosts.sh [DECK_VARIABLE VALUE ...]       default: rule ours d 4 duration 4
#   LMP=<binary> in the environment: default build/lmp
set -euo pipefail

top=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
LMP=${LMP:-$top/build/lmp}
variables=()
[ $# -gt 0 ] || set -- rule ours d 4 duration 4
while [ $# -gt 0 ]; do variables+=(-var "$1" "$2"); shift 2; done

a=slope-a-$$ b=slope-b-$$               # the hosts
work=$(mktemp -d)

say() { echo "hosts.sh: $*"; }
fail() { say "FAILED: $*"; exit 1; }

# only what was started here: the processes in the two namespaces
kill_host() {
  local pids
  pids=$(ip netns pids "$1")
  [ -z "$pids" ] || kill -KILL $pids 2> /dev/null || true
}

clean() {
  for host in "$a" "$b"; do
    kill_host "$host" 2> /dev/null || true
    ip netns del "$host" 2> /dev/null || true
  done
  rm -rf "$work"
}
trap clean EXIT

ip netns add "$a" 2> /dev/null && ip netns add "$b" 2> /dev/null || {
  say "skipped: network namespaces are not permitted (root is needed)"
  exit 77
}
ip link add veth_a netns "$a" type veth peer name veth_b netns "$b"
ip -n "$a" addr add 10.77.0.1/24 dev veth_a
ip -n "$b" addr add 10.77.0.2/24 dev veth_b
for host in "$a" "$b"; do ip -n "$host" link set lo up; done
ip -n "$a" link set veth_a up
ip -n "$b" link set veth_b up

# what ssh does on a cluster: mpirun calls AGENT HOST COMMAND...
cat > "$work/agent" << END
#!/bin/bash
host=\$1; shift
case \$host in 10.77.0.1) name=$a;; 10.77.0.2) name=$b;; esac
exec ip netns exec \$name unshare --uts bash -c "hostname \$name; exec \$*"
END
chmod +x "$work/agent"
printf '10.77.0.1 slots=1\n10.77.0.2 slots=1\n' > "$work/hostfile"

export OMP_NUM_THREADS=1 OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1

# the deck in a folder that both hosts see, from host a, with one rank on each
both() {
  (cd "$1" && shift && exec ip netns exec "$a" unshare --uts bash -c 'hostname "$0"; exec "$@"' "$a" \
    mpirun -np 2 --hostfile "$work/hostfile" --map-by node --bind-to none \
    --mca plm_rsh_agent "$work/agent" --mca btl tcp,self --mca btl_tcp_if_include 10.77.0.0/24 \
    --mca mpi_yield_when_idle 1 --mca oob_tcp_if_include 10.77.0.0/24 "$LMP" -in in.embankment "${variables[@]}" "$@")
}

for name in uncut cut; do
  mkdir "$work/$name"
  cp "$top"/inputs/20_embankment/{in.embankment,terrain.asc} "$work/$name"
done

say "uncut: two ranks on two hosts"
both "$work/uncut" > "$work/uncut.screen" 2>&1 || { tail -20 "$work/uncut.screen"; fail "the uncut run"; }
grep -q "1 by 2 by 1 MPI processor grid\|2 by 1 by 1 MPI processor grid" "$work/uncut/log.lammps" || fail "not two ranks"

say "cut: host b is killed after its second restart file"
both "$work/cut" > "$work/cut.screen" 2>&1 &
run=$!
until [ -s "$work/cut/embankment.2.restart" ]; do
  kill -0 $run 2> /dev/null || { tail -20 "$work/cut.screen"; fail "the run ended before it could be cut"; }
  sleep 0.05
done
ip netns pids "$b" | xargs -r ps -o comm= -p | grep -q "^$(basename "$LMP" | cut -c1-15)$" || fail "no rank on host b"
kill_host "$b"
died=$(date +%s%N)
for _ in $(seq 600); do kill -0 $run 2> /dev/null || break; sleep 0.1; done
kill -0 $run 2> /dev/null && fail "mpirun still waits 60 s after host b died"
wait $run && fail "mpirun ended with status 0 although host b died"
say "mpirun ended $((($(date +%s%N) - died) / 1000000)) ms after host b died"
[ -z "$(ip netns pids "$a")" ] || { sleep 2; [ -z "$(ip netns pids "$a")" ] || fail "a rank still runs on host a"; }
ip netns del "$b"

# the later of the two that is complete, as tools/slope study finds it
restart=$(PYTHONPATH=$top/tools /usr/bin/python3 -c "
from slope_tools.case import restarts
print(*restarts.restarts('$work/cut')[0])")
step=${restart%% *} restart=$(basename "${restart#* }")
say "continued at step $step, from $restart, on host a alone"
(cd "$work/cut" && ip netns exec "$a" "$LMP" -in in.embankment "${variables[@]}" -var restart "$restart" \
  > "$work/rest.screen" 2>&1) || { tail -20 "$work/rest.screen"; fail "the continued run"; }

# Rounding grows in a collapse; what is compared is known to agree for runs on any number of ranks
/usr/bin/python3 - "$work/uncut" "$work/cut" << 'END'
import sys, yaml
one, two = (yaml.safe_load(open(f"{folder}/embankment.summary.yaml")) for folder in sys.argv[1:])
print("                     uncut      continued")
def row(what, a, b, within):
    print(f"{what:16} {a:12.6g} {b:14.6g}   {abs(a - b):.1e}, allowed {within:.1e}")
    return abs(a - b) <= within
released = one["volume"]["released"]
good = [row("released, m3", released, two["volume"]["released"], 1e-9 * released),
        row("balls left", one["balls"]["present"], two["balls"]["present"], 0),
        row("balance, m3", one["volume"]["residual"], two["volume"]["residual"], 1e-9 * released),
        row("centroid, m", one["travel"]["centroid"], two["travel"]["centroid"], 0.02 * one["travel"]["centroid"]),
        row("front, m", one["travel"]["front"], two["travel"]["front"], 0.05 * one["travel"]["front"])]
sys.exit(0 if all(good) else 1)
END
say "passed"
