"""Wrong arguments of every style, wrong orders of commands, set-ups that do not fit together: each ends the run with
one line that names style, argument, rule and value."""

import os
import resource
import subprocess
from concurrent.futures import ThreadPoolExecutor

import numpy
import pytest
from deck_helpers import ALONE, ENVIRONMENT, LMP, lammps_help, run_deck, write_asc

# every style of the package once; a row of the tables below replaces a line
DECK = {
    "units": "units si",
    "dimension": "dimension 3",
    "atom_style": "atom_style sphere",
    "boundary": "boundary f f f",
    "comm": "comm_modify vel yes",
    "neighbor": "neigh_modify every 1 delay 0 check yes",
    "terrain": "region ground terrain ground.asc depth 1 headroom 4",
    "polygon": "region road polygon road.csv",
    "regions": "region block block 2 5 2 5 1 3 units box\nregion space plane 0 0 0 0 0 1 units box\n"
               "region hole block 5 6.5 5 6.5 -0.5 2 units box\nregion pit intersect 2 ground hole",
    "box": "create_box 3 ground",
    "atoms": "lattice sc 1.0\ncreate_atoms 1 region block",
    "group": "group soil type 1",
    "set": "set group soil diameter 0.9 density 2000",
    "pair": "pair_style gran/restitution",
    "coeff": "pair_coeff 1 1 stiffness 1e6 1e6 restitution 0.5 friction 30 rolling 0.1",
    "coeff wall": "pair_coeff 1 2 stiffness 1e6 1e6 restitution 0.5",
    "coeff frozen": "pair_coeff 1 3 stiffness 1e6 1e6 damping 10 0 rolling_spring 1e6 10",
    "wall": "fix wall soil wall/gran/balls 2 1.0 surface ground upper spacing 1.0 origin 0.5 0.5 outside road",
    "more walls": "fix more soil wall/gran/balls 2 1.0 file balls.txt",
    "create": "create_balls 3 1.0 2000 file balls.txt",
    "freeze": "group frozen type 3\nfix freeze frozen freeze",
    "delete": "delete_balls soil overlap 0.0",
    "move": "fix move soil nve/sphere",
    "deposit": "fix deposit soil deposit/grid 10 20 cell 1.0 terrain ground output out",
    "motion": "fix shake soil ground/motion motion.txt scale 1 start 0",
    "line": "fix line soil control/line fence.csv deposit deposit output out",
    "output": "thermo_style custom step atoms ke f_wall[3] f_deposit[10]",
    "run": "run 1",
}
FILES = {
    "road.csv": "6,0\n8,0\n8,8\n6,8\n", "line.csv": "0,0\n1,1\n", "bow.csv": "0,0\n1,1\n0,1\n1,0\n",
    "motion.txt": "# t ax ay az\n0 0 0 0\n0.5 1 0 0\n", "gal.txt": "# t ax ay az (gal)\n0 0 0 0\n0.5 100 0 0\n",
    "fence.csv": "1,7\n7 7\n", "off.csv": "1,7\n9,7\n", "far.csv": "0,0\n1e13,0\n0,1\n",
    "turned.csv": "# y,x\n1,7\n7,7\n",
    "balls.txt": "# x y z\n1 1 0\n7 7 0.5\n", "two.txt": "1 2 3\n1 2\n", "far.txt": "1e13 1 0\n",
    "order.txt": "# y x z\n1 1 0\n7 7 0.5\n", "none.txt": "# nothing\n", "outside.txt": "9 9 0\n",
    "short.asc": "ncols 2\nnrows 2\nxllcorner 0\nyllcorner 0\ncellsize 1\n1 2\n3\n",
    "far.asc": "ncols 2\nnrows 1\nxllcorner 1e300\nyllcorner 0\ncellsize 1\n1 2\n",
    "deep.asc": "ncols 2\nnrows 1\nxllcorner 0\nyllcorner 0\ncellsize 1\n1 -1e300\n",
}

# line of the deck, its command, how messages begin: the arguments -> the rest of the message, or its beginning
TABLE = {
    ("pair", "pair_style gran/restitution", "Pair gran/restitution"): """
        mass -> mass must be followed by pair|ball, got 0 of 1 values
        mass reduced -> mass must be pair or ball, got reduced
        limit_damping maybe -> limit_damping must be no or yes, got maybe
        rolling_radius 2 -> rolling_radius must be ball or reduced, got 2
        scheme euler -> scheme must be exact or plain, got euler
        scheme exact color red -> : unknown keyword color, must be mass, limit_damping, rolling_radius or scheme
        """,
    ("coeff", "pair_coeff", "Pair gran/restitution"): """
        1 4 stiffness 1 1 restitution 0.5 -> pair_coeff 1 4: types must be 1 to 3, or a range of them with *, got 4
        0 1 stiffness 1 1 restitution 0.5 -> pair_coeff 0 1: types must be 1 to 3, or a range of them with *, got 0
        a 1 stiffness 1 1 restitution 0.5 -> pair_coeff a 1: types must be 1 to 3, or a range of them with *, got a
        1 2*1 stiffness 1 1 restitution 0.5 -> pair_coeff 1 2*1: types must be 1 to 3, or a range of them with *, got 2*1
        1 1 stiffness 1e6 -> pair_coeff 1 1 stiffness must be followed by kn kt, got 1 of 2 values
        1 1 stiffness 1e6 restitution 0.5 -> pair_coeff 1 1 stiffness kt must be a finite number, got restitution
        1 1 stiffness 1.0.0 1e6 restitution 0.5 friction 30 -> pair_coeff 1 1 stiffness kn must be a finite number, got 1.0.0
        1 1 stiffness 0 1e6 restitution 0.5 -> pair_coeff 1 1 stiffness kn must be > 0, got 0
        1 1 stiffness 1e6 -1 restitution 0.5 -> pair_coeff 1 1 stiffness kt must be >= 0, got -1
        1 1 stiffness 1e6 1e6 -> pair_coeff 1 1: exactly one of restitution and damping is required, got neither
        1 1 restitution 0.5 -> pair_coeff 1 1: stiffness kn kt is required
        1 1 stiffness 1e6 1e6 restitution 0 -> pair_coeff 1 1 restitution must be > 0 and <= 1, got 0
        1 1 stiffness 1e6 1e6 restitution 1.2 -> pair_coeff 1 1 restitution must be > 0 and <= 1, got 1.2
        1 1 stiffness 1e6 1e6 restitution 0.5 damping 1 1 -> pair_coeff 1 1: exactly one of restitution and damping is
        1 1 stiffness 1e6 1e6 damping -1 0 -> pair_coeff 1 1 damping cn must be >= 0, got -1
        1 1 stiffness 1e6 1e6 damping 1 -1 -> pair_coeff 1 1 damping ct must be >= 0, got -1
        1 1 stiffness 1e6 0 damping 1 2.5 -> pair_coeff 1 1: ct must be 0 where kt is 0, got 2.5: give the contact a
        1 1 stiffness 1e6 1e6 restitution 0.5 friction 90 -> pair_coeff 1 1 friction must be >= 0 and < 90 degrees, got 90
        1 1 stiffness 1e6 1e6 restitution 0.5 friction -1 -> pair_coeff 1 1 friction must be >= 0 and < 90 degrees, got -1
        1 1 stiffness 1e6 1e6 restitution 0.5 rolling -0.1 -> pair_coeff 1 1 rolling must be >= 0, got -0.1
        1 1 stiffness 1e6 1e6 restitution 0.5 rolling_spring -1 1 -> pair_coeff 1 1 rolling_spring kr must be >= 0, got -1
        1 1 stiffness 1e6 1e6 restitution 0.5 rolling_spring 1 -1 -> pair_coeff 1 1 rolling_spring cr must be >= 0, got -1
        1 1 stiffness 1e6 1e6 restitution 0.5 rolling 0.05 rolling_spring 0 0 -> pair_coeff 1 1: rolling_spring must not be 0 0
        1 1 stiffness 1e6 1e6 restitution 0.5 color red -> pair_coeff 1 1: unknown keyword color, must be stiffness
        """,  # noqa: E501
    ("wall", "fix wall soil wall/gran/balls", "Fix wall/gran/balls wall"): """
        2 1.0 -> : needs TYPE DIAMETER and surface or file, got 2 arguments
        0 1.0 file balls.txt -> type must be 1 to 3 (the atom types of the box), got 0
        4 1.0 file balls.txt -> type must be 1 to 3 (the atom types of the box), got 4
        1.5 1.0 file balls.txt -> type must be a whole number below 2^31, got 1.5
        4294967298 1.0 file balls.txt -> type must be a whole number below 2^31, got 4294967298
        2 x file balls.txt -> diameter must be a finite number, got x
        2 0 file balls.txt -> diameter must be > 0, got 0
        2 1.0 plane ground -> needs surface or file, got plane
        2 1.0 surface -> surface must be followed by REGION side, got 0 of 2 values
        2 1.0 surface ground upper -> surface needs a spacing, got none
        2 1.0 surface ground spacing 1.0 -> surface side must be upper or lower, got spacing
        2 1.0 surface nowhere upper spacing 1.0 -> region nowhere does not exist
        2 1.0 surface road upper spacing 1.0 -> region road must have an upper boundary, got INF
        2 1.0 surface space upper spacing 1.0 -> region space must have a bounding box, style plane has none here
        2 1.0 surface ground upper spacing 0 -> spacing must be > 0, got 0
        2 1.0 surface ground upper spacing 1e-9 -> : spacing must give fewer than 2^31 balls, got 6.4e+19 with 1e-09
        2 1.0 surface ground upper spacing 1 origin 1 x -> origin y must be a finite number, got x
        2 1.0 surface ground upper spacing 1 origin 0 1e300 -> origin y must be within +-1e+12, got 1e300
        2 1.0 surface ground upper spacing 1 sink 0.04 -> sink must be 0 or at least 0.05 (0.05 diameters), got 0.04
        2 1.0 surface ground upper spacing 1 sink 1 -> : sink must be < 1, so that the balls lie above the bottom of reg
        2 1.0 surface block lower spacing 1 sink 2.5 -> : sink must be < 2, so that the balls lie above the bottom of th
        2 1.0 surface pit lower spacing 1 sink 0.6 -> : sink must be < 0.5, so that the balls lie above the bottom of re
        2 1.0 surface ground upper spacing 1 outside block sunk -1 -> sunk must be 0 or at least 0.05 (0.05 diameters),
        2 1.0 surface ground upper spacing 1 sunk 1 -> sunk needs outside REGION, got none
        2 1.0 surface ground upper spacing 1 inside block sunk 1 -> sunk needs outside REGION, got none
        2 1.0 surface ground upper spacing 1 outside road sunk 1 -> sunk region road must have a lower boundary, got INF
        2 1.0 surface ground lower spacing 1 sink 0.5 rim within -> rim is no keyword any more, ground and slip surface
        2 1.0 surface ground upper spacing 1 smallest 0 -> smallest must be > 0, got 0
        2 1.0 file balls.txt sink 0.5 -> : unknown keyword sink, must be inside, outside, write or zone
        2 1.0 surface ground upper spacing 1 inside nowhere -> region nowhere does not exist
        2 1.0 surface ground upper spacing 1 inside road outside road -> : the surface of region ground holds no balls
        2 1.0 surface ground upper spacing 1 color red -> : unknown keyword color, must be spacing, origin, pattern,
        2 1.0 surface ground upper spacing 1 write none/a.txt -> : cannot write none/a.txt: No such file or directory
        2 1.0 file missing.txt -> : cannot read missing.txt: No such file or directory
        2 1.0 file order.txt -> : order.txt, line 1: columns must be x y z in m, got y x z
        2 1.0 file far.txt -> : far.txt, line 1: x must be within +-1e+12, got 1e+13
        2 1.0 file none.txt -> : file none.txt holds no balls
        """,
    ("terrain", "region ground terrain", "Region terrain"): """
        -> : file name is missing
        missing.asc -> : cannot read missing.asc: No such file or directory
        . -> : cannot read .: Is a directory
        short.asc -> : short.asc, line 7: only 3 of 4 values (2 rows x 2 columns)
        road.csv -> : road.csv, line 1: must be a header key of an ESRI ASCII grid or a number, got 6,0
        far.asc -> : far.asc with depth and headroom must have an extent within +-1e+12, got x 1e+300 to 1e+300, y 0
        deep.asc -> : deep.asc with depth and headroom must have an extent within +-1e+12, got x 0 to 2, y 0 to 1, z
        ground.asc depth -> depth must be followed by H, got 0 of 1 values
        ground.asc depth 0 -> depth must be > 0, got 0
        ground.asc depth 1e300 -> : ground.asc with depth and headroom must have an extent within +-1e+12, got x 0 to
        ground.asc headroom 0 -> headroom must be > 0, got 0
        ground.asc color red -> : unknown keyword color, must be depth, headroom, side, units, move or rotate
        ground.asc units lattice -> units must be box, got lattice
        ground.asc side up -> side must be in or out, got up
        ground.asc open 1 -> cannot have open faces
        ground.asc move x NULL NULL -> move v_x must be v_name or NULL, got x
        ground.asc rotate NULL 0 0 0 0 0 1 -> rotate v_theta must be v_name, got NULL
        ground.asc rotate v_a 0 0 0 0 0 up -> rotate Rz must be a finite number, got up
        """,
    ("polygon", "region road polygon", "Region polygon"): """
        -> : file name is missing
        missing.csv -> : cannot read missing.csv: No such file or directory
        line.csv -> : line.csv, line 1: a ring must have at least 3 points, got 2
        bow.csv -> : bow.csv, line 1: a ring must not cross or touch itself, the edges from lines 1 and 3 meet at
        road.csv color red -> : unknown keyword color, must be side, units, move or rotate
        road.csv side up -> side must be in or out, got up
        """,
    ("create", "create_balls", "Create_balls"): """
        3 1.0 2000 -> needs TYPE DIAMETER DENSITY and surface, file or fill, got 3 arguments
        4 1.0 2000 file balls.txt -> type must be 1 to 3 (the atom types of the box), got 4
        3 0 2000 file balls.txt -> diameter must be > 0, got 0
        3 1.0 -1 file balls.txt -> density must be > 0, got -1
        3 1.0 2000 lattice sc -> needs surface, file or fill, got lattice
        3 1.0 2000 fill -> fill must be followed by REGION [seed N], got no words
        3 1.0 2000 fill ground spacing 1 -> fill: unknown keyword spacing, must be seed
        3 1.0 2000 fill ground seed 0 -> fill seed must be > 0, got 0
        3 1.0 2000 fill nowhere -> fill region nowhere does not exist
        3 1e3 2000 fill ground -> fill region ground must have room for a ball of diameter 1000
        3 1e-4 2000 fill ground -> fill diameter must be so large that the box around region ground has room
        3 1.0 2000 file outside.txt -> balls must lie in the simulation box (below its upper faces), got 1 of 1
        3 1.0 2000 file two.txt -> : two.txt, line 2: must be 3 numbers, x y z, got 1 2
        3 1.0 2000 file balls.txt write a.txt -> : unknown keyword write, must be inside or outside
        3 1.0 2000 surface ground upper spacing 1 write a.txt -> : unknown keyword write, must be spacing, origin,
        3 1.0 2000 surface nowhere upper spacing 1 -> region nowhere does not exist
        """,
    ("delete", "delete_balls", "Delete_balls"): """
        soil overlap -> needs GROUP overlap FRACTION, got 2 arguments
        soil overlap 0.0 0.1 -> needs GROUP overlap FRACTION, got 4 arguments
        nobody overlap 0.0 -> group must exist, got nobody
        soil touching 0.0 -> keyword must be overlap, got touching
        soil overlap -0.1 -> overlap must be >= 0 and < 1 (of the radius), got -0.1
        soil overlap 1 -> overlap must be >= 0 and < 1 (of the radius), got 1
        """,
    ("deposit", "fix deposit soil deposit/grid", "Fix deposit/grid"): """
        10 -> needs Nevery Nfreq cell S terrain REGION output PREFIX
        10 20 -> keyword cell is missing
        x 20 cell 1 -> Nevery must be a whole number below 2^31, got x
        0 20 cell 1 -> Nevery must be >= 1, got 0
        10 15 cell 1 -> Nfreq must be 0 or a multiple of Nevery 10, got 15
        10 -10 cell 1 -> Nfreq must be 0 or a multiple of Nevery 10, got -10
        10 20 cell 1.0 output out -> keyword terrain is missing
        10 20 cell 1.0 terrain ground -> keyword output is missing
        10 20 cell 0 -> cell must be > 0, got 0
        10 20 cell 1e-4 terrain ground output out -> cell must give at most 2147483647 cells, got 6400000000 cells, they
        10 20 cell 1 terrain nowhere output out -> terrain region nowhere does not exist
        10 20 cell 1 terrain road output out -> terrain region road must have an upper boundary, got INF
        10 20 cell 1 terrain space output out -> terrain region space must have a bounding box, style plane has none
        10 20 cell 1 terrain ground output none/out -> : cannot write none/out.summary.yaml: No such file or directory
        10 20 cell 1e300 -> cell must be at most 1e+12, got 1e300
        10 20 bulk 1e300 -> bulk must be at most 1000, got 1e300
        10 20 bulk 0 -> bulk must be > 0, got 0
        10 20 bulk region -> bulk region must be followed by REGION, got 0 of 1 values
        10 20 cell 1 terrain ground output out bulk region nowhere -> bulk region nowhere does not exist
        10 20 motion -1 -> motion must be > 0, got -1
        10 20 window 15 -> window must be a multiple of Nevery 10, got 15
        10 20 window 0 -> window must be a multiple of Nevery 10, got 0
        10 20 series maybe -> series must be yes or no, got maybe
        10 20 extent 0 8 0 x -> extent yhi must be a finite number, got x
        10 20 cell 1 terrain ground output out extent 8 0 0 8 -> extent must have xlo < xhi and ylo < yhi, got 8 0 0 8
        10 20 cell 1 terrain ground output out extent 0 9 0 8 -> extent must lie in that of region ground, 0 8 0 8
        10 20 rest 0 -> rest must be > 0, got 0
        10 20 rest 0.2 -> rest must be at most 0.1, got 0.2
        10 20 color red -> : unknown keyword color, must be cell, terrain, output, bulk, extent, motion, rest, window or
        """,  # noqa: E501
    ("motion", "fix shake soil ground/motion", "Fix ground/motion"): """
        -> needs FILE with lines t ax ay az
        no.txt -> : cannot read no.txt: No such file or directory
        gal.txt -> : gal.txt, line 1: columns must be t ax ay az in s and m/s2, got t ax ay az (gal)
        motion.txt scale x -> scale must be a finite number, got x
        motion.txt color red -> : unknown keyword color, must be scale or start
        """,
    ("line", "fix line soil control/line", "Fix control/line"): """
        -> needs FILE deposit ID output PREFIX
        fence.csv deposit deposit -> keyword output is missing
        fence.csv output out color red -> : unknown keyword color, must be deposit, lower or output
        fence.csv output out lower x -> lower must be a finite number, got x
        no.csv output out -> : cannot read no.csv: No such file or directory
        far.csv output out -> : far.csv, line 2: x and y must be within +-1e+12, got 1e+13 0
        turned.csv output out -> : turned.csv, line 1: columns must be x y or x,y in m, got y,x
        off.csv output out -> line: points of off.csv must lie in the terrain, x 0 to 8, y 0 to 8, got 9 7
        fence.csv deposit wall output out -> line deposit must be the ID of a fix deposit/grid, got wall
        fence.csv deposit deposit output no/out -> : cannot write no/out.line.csv: No such file or directory
        """,
}

# lines of the deck that are changed, the message
NO_BALLS = {"atom_style": "atom_style atomic", "set": "mass * 1.0", "comm": "", "move": "", "freeze": "", "output": ""}
FLAT = {"dimension": "dimension 2", "boundary": "boundary f f p", "terrain": "region ground block 0 8 0 8 -0.1 0.1",
        "atoms": "create_atoms 1 single 1 1 0", "move": "", "freeze": "", "output": ""}
ONLY = dict.fromkeys(("pair", "coeff", "coeff wall", "coeff frozen", "wall", "more walls", "create", "delete",
                      "deposit", "motion", "line"), "")
SETUPS = [
    # the order of commands
    ({"units": "create_balls 3 1.0 2000 file balls.txt"}, "Create_balls before the simulation box is defined"),
    ({"units": "delete_balls soil overlap 0.0"}, "Delete_balls before the simulation box is defined"),
    ({"wall": "fix field soil wall/gran/balls 2 1.0 surface ground upper spacing 1 outside pit\n"
              "fix wall soil wall/gran/balls 2 1.0 surface pit lower spacing 0.5 sink 0.4"},
     "Fix wall/gran/balls wall sink must come before fix field, which is outside region pit: define that after this"),
    ({"set": "delete_balls soil overlap 0.0"}, "Delete_balls requires a fix wall/gran/balls before it, there is none"),
    ({"set": "fix early all deposit/grid 10 20 cell 1.0 terrain late output out\nregion late terrain ground.asc"},
     "Fix deposit/grid terrain region late does not exist"),
    ({"wall": "fix even all balance 10 1.1 shift xyz 5 1.1\n" + DECK["wall"]},
     "Fix wall/gran/balls wall: must come before fix even balance, which moves atoms between ranks"),
    ({"atoms": "", "set": "", "delete": ""}, "Fix deposit/grid group must hold balls when the run starts, got none"),

    # what a style needs and the deck does not have
    ({"comm": ""}, "Pair gran/restitution requires ghost velocities: comm_modify vel yes"),
    ({"coeff": ""}, "Pair gran/restitution: pair_coeff 1 1 is not set, and balls of both types exist"),
    ({"coeff wall": ""}, "Fix wall/gran/balls: pair_coeff 1 2 is not set (moving type 1, wall type 2)"),
    ({"coeff frozen": ""}, "Pair gran/restitution: pair_coeff 1 3 is not set, and balls of both types exist"),
    ({"freeze": ""}, "Pair gran/restitution: pair_coeff 3 3 is not set, and balls of both types exist"),
    ({"pair": "pair_style zero 2.0", "coeff": "pair_coeff * *", "coeff wall": "", "coeff frozen": ""},
     "Fix wall/gran/balls wall: requires pair_style gran/restitution, which holds its coefficients"),
    ({**NO_BALLS, **ONLY, "pair": DECK["pair"], "coeff": DECK["coeff"]},
     "Pair gran/restitution requires balls: atom_style must be sphere, got atomic"),
    ({**NO_BALLS, **ONLY, "create": DECK["create"]},
     "Create_balls atom_style must have radius and mass per atom, as sphere has, got atomic"),
    ({**NO_BALLS, **ONLY, "delete": DECK["delete"]},
     "Delete_balls requires balls: atom_style must be sphere, got atomic"),
    ({**NO_BALLS, **ONLY, "deposit": DECK["deposit"]},
     "Fix deposit/grid requires balls: atom_style must be sphere, got atomic"),
    ({**NO_BALLS, **ONLY, "line": DECK["line"]},
     "Fix control/line requires balls: atom_style must be sphere, got atomic"),

    # what does not fit together
    ({**FLAT, **ONLY, "create": DECK["create"]},
     "Create_balls dimension must be 3, got 2"),
    ({**FLAT, **ONLY, "deposit": DECK["deposit"]},
     "Fix deposit/grid requires a simulation in 3 dimensions, got 2"),
    ({"set": "set group soil diameter 1.5 density 2000", "delete": ""},
     "Pair gran/restitution: 254 pairs overlap at the start by more than 5 % of the radius, worst 66.67 % between "
     "ball 1"),
    ({"more walls": "fix more soil wall/gran/balls 2 5.0 file balls.txt", "delete": ""},
     "Fix wall/gran/balls more: 5 pairs overlap at the start by more than 5 % of the radius, worst 270.7 % between "
     "ball 1"),
    ({"more walls": "fix more soil wall/gran/balls 2 500.0 file balls.txt"},
     "Delete_balls: no ball of group soil is left"),
    ({"terrain": "variable up equal 0.1\n" + DECK["terrain"] + " move NULL NULL v_up"},
     "Fix wall/gran/balls wall region ground must not move, got one that moves or varies"),
    ({"box": "region big block 0 8 0 8 -1e20 1e20\ncreate_box 3 big"},
     "Region polygon road has no end in z: the simulation box needs one"),
    ({"deposit": DECK["deposit"] + "\n"
      + DECK["deposit"].replace("deposit soil", "other soil").replace("cell 1.0", "cell 2")},
     "Fix deposit/grid output must differ from that of fix other, got out"),
    ({"line": DECK["line"] + "\n" + DECK["line"].replace("line soil", "other soil")},
     "Fix control/line output must differ from that of fix other, got out"),
    ({"line": "fix line soil control/line fence.csv output out",
      "deposit": DECK["deposit"] + "\n" + DECK["deposit"].replace("deposit soil", "other soil") + "2"},
     "Fix control/line line needs deposit ID, the fix deposit/grid that has the bulk factor, where there is not "
     "exactly one, got 2"),
    ({**FLAT, **ONLY, "pair": DECK["pair"], "coeff": DECK["coeff"], "move": "fix move all nve/sphere disc"},
     "Pair gran/restitution: fix move nve/sphere must turn balls as solid spheres, got disc"),
    ({"run": "run_style respa 2 2\nrun 1"}, "Pair gran/restitution needs run_style verlet, got respa"),
    ({"run": "minimize 1e-6 1e-6 10 10"}, "Pair gran/restitution needs run, got minimize"),
    ({"pair": DECK["pair"] + "\npair_modify compute no"},
     "Pair gran/restitution pair_modify compute must be yes, got no"),
    ({"units": "units real"}, "Pair gran/restitution units must be si, cgs, lj, micro or nano, got real"),
    ({"move": "fix move soil rigid single"},
     "Pair gran/restitution: balls must move one by one, got fix move rigid, whose bodies have another mass"),
    ({"move": "fix move soil rigid/nve single"},
     "Pair gran/restitution: balls must move one by one, got fix move rigid/nve, whose bodies"),
    ({"deposit": "region high sphere 4 4 9 3 units box\n" + DECK["deposit"].replace("terrain ground", "terrain high")},
     "Fix deposit/grid terrain region high must have a height within one "),
]

# what LAMMPS itself says when our styles are asked for what they do not have
OF_LAMMPS = [
    ({"terrain": DECK["terrain"] + " side out"}, "Create_box region does not support a bounding box"),
    ({"output": "fix_modify wall virial yes"}, "Illegal fix_modify command"),
    ({"output": "fix_modify deposit energy yes"}, "Illegal fix_modify command"),
    ({"output": "thermo_style custom step f_wall[4]"}, "Thermo fix vector is accessed out-of-range"),
    ({"output": "thermo_style custom step f_deposit[12]"}, "Thermo fix vector is accessed out-of-range"),
    ({"output": "compute sum all reduce sum f_wall"}, "Compute reduce fix calculates global values"),
    ({"output": "compute c all pair/local p11\ndump d all local 1 out.txt index c_c"},
     "Pair style does not have extra field requested by compute pair/local"),
]


def rows():
    for (line, command, style), text in TABLE.items():
        for row in text.strip().splitlines():
            arguments, message = row.strip().split("-> ")
            yield {line: f"{command} {arguments}"}, style + ("" if message[0] == ":" else " ") + message
    yield from SETUPS
    if "29 Sep 2021" in lammps_help():     # others put it in other words
        yield from OF_LAMMPS


ROWS = list(rows())


@pytest.fixture(scope="module")
def said(tmp_path_factory):
    """What LAMMPS says of each row: exit status, output."""
    rows_folder = tmp_path_factory.mktemp("rows")

    def run(number):
        folder = rows_folder / str(number)
        folder.mkdir()
        for name, text in FILES.items():
            (folder / name).write_text(text)
        write_asc(folder / "ground.asc", numpy.zeros((8, 8)))
        deck = "\n".join({**DECK, **(ROWS[number][0] if number >= 0 else {})}.values()) + "\n"
        done = subprocess.run([LMP, "-log", "none"], input=deck, cwd=folder, env={**ENVIRONMENT, **ALONE}, timeout=60,
                              text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
        return done.returncode, done.stdout
    with ThreadPoolExecutor(2) as pool:
        return dict(zip(range(-1, len(ROWS)), pool.map(run, range(-1, len(ROWS)))))


def test_the_deck_without_a_change_runs(said):
    status, text = said[-1]
    assert status == 0 and "ERROR" not in text and "WARNING" not in text, text[-2000:]


@pytest.mark.parametrize("number", range(len(ROWS)), ids=lambda number: "; ".join(ROWS[number][0].values())[:70])
def test_one_clear_line(said, number):
    status, text = said[number]
    errors = [line for line in text.splitlines() if line.startswith("ERROR")]
    assert status == 1 and len(errors) == 1, text[-2000:]
    assert errors[0].startswith("ERROR: " + ROWS[number][1]) and errors[0].isprintable(), errors[0]


# --- rasters larger than the memory ---

HEAD = "ncols {0}\nnrows {0}\nxllcorner 0\nyllcorner 0\ncellsize 1\n"


@pytest.mark.skipif("ASAN_OPTIONS" in os.environ, reason="a sanitizer reserves more address space than there is memory")
@pytest.mark.parametrize("cells, written, size", [(20_000, 0, 800_000_000), (6_400, 40_000_000, None)])
def test_a_raster_beyond_the_memory_is_refused(tmp_path, monkeypatch, cells, written, size):
    """Without room for the text, of which the disk has only the first bytes, and for the heights: of 400 MB."""
    with open(tmp_path / "large.asc", "w") as out:
        out.write(HEAD.format(cells) + "1 " * written)
        out.flush()
        if size:
            out.truncate(size)
    monkeypatch.setattr(subprocess, "run", limited(subprocess.run, 400_000_000))
    run_deck("region ground terrain large.asc\n", tmp_path, expect_error="Region terrain: not enough memory")


SEARCHED = """region ground terrain large.asc
find_slip ground strength 3000 19.6 2039 surface sphere 1485 1500 30 29 output crit
"""
DENSE = """
units si
atom_style sphere
boundary f f f
comm_modify vel yes
region all block 0 16 0 16 -1 16
create_box 2 all
create_atoms 1 single 8 8 8.2
set group all diameter 16 density 2000
neighbor 0.2 bin
pair_style gran/restitution
pair_coeff * * stiffness 1e6 1e6 restitution 0.5 friction 30
region flat block 0 16 0 16 -1 0
fix balls all wall/gran/balls 2 0.01 surface flat upper spacing 0.009
fix move all nve/sphere
timestep 1e-4
run 1
"""


@pytest.mark.skipif("ASAN_OPTIONS" in os.environ, reason="a sanitizer reserves more address space than there is memory")
def test_a_search_beyond_the_memory_is_refused(tmp_path, monkeypatch):
    """The raster fits, what the search keeps for each cell does not; which limit that is depends on the program."""
    (tmp_path / "large.asc").write_text(HEAD.format(3000) + ("5 " * 1500 + "9 " * 1500 + "\n") * 3000)
    found = []
    for limit in range(240, 320, 20):
        with monkeypatch.context() as one:
            one.setattr(subprocess, "run", limited(subprocess.run, limit * 1_000_000))
            with pytest.raises(AssertionError) as failed:
                run_deck(SEARCHED, tmp_path)
        errors = [line for line in str(failed.value).splitlines() if line.startswith("ERROR")]
        assert len(errors) == 1 and "not enough memory" in errors[0], str(failed.value)[-500:]
        found.append("not enough memory for the terrain and the search" in errors[0])
    assert any(found) and not list(tmp_path.glob("crit*"))


@pytest.mark.skipif("ASAN_OPTIONS" in os.environ, reason="a sanitizer reserves more address space than there is memory")
def test_fixed_balls_beyond_the_memory_are_refused(tmp_path, monkeypatch):
    """Two million near one ball: they are made in the set-up of a run, by one rank alone."""
    monkeypatch.setattr(subprocess, "run", limited(subprocess.run, 240_000_000))
    run_deck(DENSE, tmp_path,
             expect_error="Fix wall/gran/balls balls: not enough memory for the fixed balls near 1 balls")


def limited(run, limit):
    def run_limited(*args, **options):
        return run(*args, **options, preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_AS, (limit, limit)))
    return run_limited


def test_a_raster_of_a_billion_cells_of_a_short_file(tmp_path):
    """The memory is that of the file, not of what its head promises."""
    (tmp_path / "short.asc").write_text(HEAD.format(30_000) + "1 2 3\n")
    run_deck("region ground terrain short.asc\n", tmp_path, expect_error="only 3 of 900000000 values")
    (tmp_path / "many.asc").write_text(HEAD.format(50_000) + "1 2 3\n")
    run_deck("region ground terrain many.asc\n", tmp_path,
             expect_error="50000 x 50000 cells would need 20 GB of memory, at most 2147483647 cells are possible")
