#!/usr/bin/env bash
# A picture inside ParaView equals the one of plain VTK. Installs Debian's paraview where apt can;
# skips, loudly, where it cannot. Usage: run.sh PYTHON [FOLDER for what is downloaded]
set -euo pipefail
tree=$(cd "$(dirname "$0")/../.." && pwd)
python=$1
cache=${2:-$tree/build/paraview}
# Pictures stay in the folder PARAVIEW_PICTURES, where there is one
work=${PARAVIEW_PICTURES:-}
if [ -z "$work" ]; then
    work=$(mktemp -d)
    trap 'rm -rf "$work"' EXIT
fi

skip() {
    echo "!!! SKIPPED: ParaView was NOT tested: $1" >&2
    exit 0
}

if ! command -v pvbatch > /dev/null || ! command -v xvfb-run > /dev/null; then
    [ "$(id -u)" = 0 ] && command -v apt-get > /dev/null || skip "there is no pvbatch, and no apt to install it"
    apt-get update -qq || skip "apt is not reachable"
    DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends \
        paraview python3-paraview xvfb xauth > "$work/apt.log" 2>&1 || skip "apt cannot install paraview"
fi

# ParaView has its own Python, VTK and NumPy: a folder with Numba and the readers beside it
system=/usr/bin/python3
version=$($system -c 'import sys; print("%d.%d" % sys.version_info[:2])')
if [ ! -d "$cache/numba" ]; then
    "$python" -m pip install --quiet --target "$cache" --python-version "$version" \
        --only-binary=:all: numba "numpy<2" SimpleITK pydicom || skip "pip cannot install Numba"
fi
# The package as it is when installed, always at one place: Numba's cache goes by it
site=$cache/site
rm -rf "$site" && mkdir -p "$site"
cp -r "$tree/vtkmcvr" "$site/"
rm -rf "$site/vtkmcvr/filters"
cp -r "$tree/filters" "$site/vtkmcvr/filters"

volume=$("$python" "$tree/tests/paraview/outside.py" volume "$work")
export NUMBA_CACHE_DIR="${NUMBA_CACHE_DIR:-$tree/build}/paraview"
inside() {
    PYTHONPATH="$site:$cache" timeout 900 xvfb-run -a pvbatch "$tree/tests/paraview/inside.py" \
        "$site/vtkmcvr/filters/paraview/plugin/vtkmcvr_plugin.py" "$volume" "$work"
}
# A display that has just closed may leave its number locked for a moment
inside || { sleep 5; inside; }
"$python" "$tree/tests/paraview/outside.py" compare "$volume" "$work"
echo "ParaView's picture has the same bits as plain VTK's"
