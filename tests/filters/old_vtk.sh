#!/usr/bin/env bash
# The filters' tests with the oldest VTK that they are for, without PyVista: what ParaView 5.11 has.
# Usage: old_vtk.sh PYTHON3.11 [FOLDER for the environment]
set -euo pipefail
tree=$(cd "$(dirname "$0")/../.." && pwd)
python=$1
cache=${2:-$tree/build/vtk92}

skip() {
    echo "!!! SKIPPED: VTK 9.2 was NOT tested: $1" >&2
    exit 0
}

"$python" -c 'import sys; sys.exit(sys.version_info[:2] != (3, 11))' || skip "its wheels end with Python 3.11"
if [ ! -f "$cache/installed" ]; then
    "$python" -m venv "$cache"
    "$cache/bin/python" -m pip install --quiet --disable-pip-version-check \
        "vtk==9.2.6" "numpy<2" numba pytest pydicom SimpleITK || skip "pip cannot install it"
    touch "$cache/installed"
fi
# The package as it is when installed
rm -rf "$cache/site" && mkdir -p "$cache/site"
cp -r "$tree/vtkmcvr" "$cache/site/"
rm -rf "$cache/site/vtkmcvr/filters"
cp -r "$tree/filters" "$cache/site/vtkmcvr/filters"

show=()
if [ -z "${DISPLAY:-}" ] && command -v xvfb-run > /dev/null; then show=(xvfb-run -a); fi
without=(--ignore "$tree/tests/filters/test_volume_reader.py")
# Without a display VTK 9.2 draws nothing to compare with
if [ -z "${DISPLAY:-}" ] && [ ${#show[@]} = 0 ]; then without+=(--ignore "$tree/tests/filters/test_from_renderer.py"); fi
cd "$cache/site"
export NUMBA_CACHE_DIR="${NUMBA_CACHE_DIR:-$tree/build}/vtk92" PYTHONPATH=$cache/site
# At single points, where functions end or step, VTK 9.2 gives the value of the other side
"${show[@]}" "$cache/bin/python" -m pytest -q -c "$tree/pyproject.toml" --rootdir "$tree" -p no:cacheprovider \
    -m "not slow" -k "not test_random" "${without[@]}" \
    "$tree/tests/filters" "$tree/tests/test_vtk_scene.py" "$tree/tests/test_vtk_cutting.py"
