#!/bin/bash
# numpy-stl gives the volume and the centre of gravity of a closed surface. In national coordinates the volume of a body
# of 40 m x 40 m x 5 m is right to the cubic metre, and its vertices are, to 8 mm or 25 cm; but the centre of the same
# body is metres away from its place in a plane rectangular system, kilometres in UTM: it is a sum in single precision.
# shellcheck source-path=SCRIPTDIR source=debian.bash
source "$(dirname "${BASH_SOURCE[0]}")/debian.bash"

unpack python3-stl 2.9.0-2+b3

cat >look.py <<'PYTHON'
import numpy as np
from stl import mesh

box = np.array([[x, y, z] for x in (0, 40) for y in (0, 40) for z in (0, 5)])
faces = [[0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1],
         [2, 3, 7], [2, 7, 6], [0, 2, 6], [0, 6, 4], [1, 5, 7], [1, 7, 3]]
corners = {"local": (0.1, 0.2, 0.3), "plane": (-7003.37, -120011.61, 103.3), "UTM": (500003.37, 4000011.61, 103.3)}
for name, corner in corners.items():
    body = mesh.Mesh(np.zeros(12, dtype=mesh.Mesh.dtype))
    body.vectors[:] = (box + corner)[faces]
    volume, centre, _ = body.get_mass_properties()
    error = np.hypot(*(centre - corner - (20, 20, 2.5))[:2])
    print(f"{name}: {volume:.0f} m3, {error:.0f} m;")
PYTHON
seen=$(PYTHONHOME=$usr run python3.11 -W ignore look.py 2>look.log | xargs) || { cat look.log >&2; exit 1; }

echo "software:     numpy-stl, $version of Debian 12"
echo "a good guess: 8000 m3, and 0 m from its centre to the one given, in each system"
echo "seen:         $seen"
# the last digits of such sums depend on the processor
changed() { echo "CHANGED: it was 8000 m3 and some 0, 5 and 4000 m" >&2; exit 1; }
[[ $seen =~ ^"local: 8000 m3, 0 m; plane: 8000 m3, "([0-9]+)" m; UTM: 8000 m3, "([0-9]+)" m;"$ ]] || changed
((BASH_REMATCH[1] > 1 && BASH_REMATCH[2] > 1000)) || changed
