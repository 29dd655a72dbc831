"""Bounds of the contact law: beyond them one line says what, where and the value; restart files carry a version."""
import struct

import pytest

from deck_helpers import run_deck
from test_guards import run

# as in src/contacts/contact_coeffs.h
VERSION = 20261126


def law_warnings(warnings):
    return [w for w in warnings if "damping ratio" in w or "masses of balls" in w]


# ball of 1309 kg, k 1e7: critical is 2.288e5 N s/m
@pytest.mark.parametrize("style, cn, ratio", [("", 4.5e5, None), ("", 5e5, 2.185), ("scheme plain", 5e5, None)])
def test_damping_ratio(tmp_path, style, cn, ratio):
    warnings, summary = run(tmp_path, style=style, e=f"0.5\npair_coeff * * stiffness 1e7 1e7 damping {cn} 0", steps=10)
    told = law_warnings(warnings)
    if ratio is None:
        assert told == []
        return
    one = [w for w in told if "types 1 and 2" in w]
    assert len(one) == 1 and one[0] in summary["warnings"], told
    assert f"must be <= 2 to be followed in time, got {ratio}" in one[0] and "cn 5e+05 N s/m" in one[0]


@pytest.mark.parametrize("ratio, told", [(900, False), (1100, True)])
def test_mass_ratio(tmp_path, ratio, told):
    small = (1.0 / ratio)**(1 / 3)
    warnings, summary = run(tmp_path, atoms="create_atoms 1 single 8 8 5", dt=1e-5, steps=2,
                            neigh=f"set atom 2 diameter {small} density 2500")
    found = law_warnings(warnings)
    assert len(found) == told, warnings
    if told:
        assert "types 1 and 1 that can touch are tested up to a ratio of 1000, got 1100" in found[0]
        assert found[0] in summary["warnings"]


def named(name, number):
    """A number of a restart file, with its name before it."""
    return name.encode().ljust(24, b"\0") + struct.pack("<3d", 1.0, -2.0, number)


# another version; as written before members had names: a format and four whole numbers
@pytest.mark.parametrize("other, got", [
    (named("pair_style", VERSION - 1), f"got {VERSION - 1}:"),
    (b"", "got none, or those of an earlier version:")])
def test_restart_file_of_another_version(tmp_path, other, got):
    run(tmp_path, steps=10, neigh="restart 10 cut.*.restart")
    data = (tmp_path / "cut.10.restart").read_bytes()
    mine = named("pair_style", VERSION)
    assert data.count(mine) == 1 and data.count(named("kn", 1e7)) >= 1
    if other:
        changed = data.replace(mine, other)
    else:
        head = data.index(mine) - 24
        changed = data[:head] + struct.pack("<5i", 20261123, 0, 0, 0, 0) + data[head + 20:]
    (tmp_path / "cut.10.restart").write_bytes(changed)
    run_deck("read_restart cut.10.restart\n", tmp_path,
             expect_error="Pair gran/restitution: the restart file must have data of version "
             f"{VERSION}, {got} start again")
