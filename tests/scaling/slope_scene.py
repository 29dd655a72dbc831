"""The scene of many_balls.py and terrain_size.py: a body of touching balls of 1 m on a rough slope of 30 degrees."""

START = """units si
suffix slope
atom_style sphere
boundary s s fs
comm_modify vel yes
processors 1 * 1
region ground terrain slope.asc depth 40 headroom 60
"""

# from region body to the fixes; needs atom types up to 3
BODY = """create_box 3 all
lattice sc 0.9995    # touching
create_atoms 1 region body
group soil type 1
set group soil diameter 1.0 density 2700
pair_style gran/restitution
pair_coeff * * stiffness 1e8 1e8 restitution 0.5 friction 30 rolling 0.05
fix bed soil wall/gran/balls 3 1.0 surface ground upper spacing 1.0
delete_balls soil overlap 0.0
neighbor 0.2 bin
neigh_modify every 1 delay 0 check yes binsize 1.2
atom_modify sort 1000 20
timestep 9e-4
fix move soil nve/sphere
fix weight soil gravity 9.80665 vector 0 0 -1
"""


def write_slopes(folder, width, cell, columns, top):
    """slope.asc, and what is 1.5 m (bed.asc) and top (top.asc) above it, m: falling in -x, width in y."""
    rows = round(width / cell) + 1
    for name, lift in (("slope", 0.0), ("bed", 1.5), ("top", top)):
        row = " ".join(f"{0.57735 * cell * i + lift:.4f}" for i in range(columns))
        (folder / f"{name}.asc").write_text(
            f"ncols {columns}\nnrows {rows}\nxllcorner {-cell / 2:g}\nyllcorner {-cell / 2:g}\ncellsize {cell}\n"
            "NODATA_value -9999\n" + "\n".join([row] * rows) + "\n")
