"""What slope site found when it made a folder, as its site.yaml keeps it, of whatever version."""
from dataclasses import dataclass, field, fields
from typing import Any, Dict, Mapping, Optional, Tuple

from ..schemas import NUMBER, TEXT, list_of, mapping, dict_of
from .site_budget import Trial
from .site_sections import Numbers, Texts, frozen

MEASURED = set(Trial._fields) - set(Trial._field_defaults)      # of a trial: what each version has
PART = mapping({}, null=True)
BODIES = {**dict_of(mapping({"volume_m3": NUMBER})), "type": ["object", "null"]}
ZONES = list_of(mapping({"name": TEXT, "variables": TEXT}, share=NUMBER), null=True)
SCHEMA = mapping({}, found=mapping(
    {}, null=True, **dict.fromkeys(("derived", "sources_sha256", "trial", "trial_of"), PART),
    files=list_of(TEXT, null=True), roads=list_of(TEXT, null=True), bodies=BODIES, zones=ZONES,
    body=mapping({}, null=True, volume=NUMBER), origin=mapping({}, null=True, east=NUMBER, north=NUMBER),
    blocks=mapping({}, null=True, down=list_of(NUMBER))))


@dataclass(frozen=True)
class Origin:
    """Of the local metres."""
    east: float = 0.0
    north: float = 0.0


@dataclass(frozen=True)
class Zone:
    """Of the ground; variables: the end of their names in the deck; values: its own ones; share: of the terrain."""
    name: str
    variables: str
    values: Mapping[str, float]
    share: float


@dataclass(frozen=True)
class Body:
    """m3, m; depths: None in older sites."""
    volume: float
    mean_depth: Optional[float] = None
    largest_depth: Optional[float] = None


@dataclass(frozen=True)
class SlipBody:
    """One of several; base_sha256: of the file that slope stability wrote."""
    volume_m3: float
    mean_depth_m: Optional[float] = None
    base_sha256: str = ""


@dataclass(frozen=True)
class Found:
    """failed: why the site could not be made; derived: {"section.key": value} of the choices that were determined."""
    failed: Optional[str] = None
    files: Texts = ()
    deck_sha256: Optional[str] = None
    choices_sha256: str = ""
    sources_sha256: Mapping[str, str] = field(default_factory=dict)
    derived: Mapping[str, Any] = field(default_factory=dict)
    origin: Origin = Origin()
    zones: Tuple[Zone, ...] = ()
    roads: Texts = ()
    body: Optional[Body] = None
    bodies: Mapping[str, SlipBody] = field(default_factory=dict)        # by rank
    balls: int = 0
    trial: Optional[Trial] = None
    trial_of: Mapping[str, Any] = field(default_factory=dict)
    down: Numbers = ()          # of blocks: unit vector of the fall line

    @classmethod
    def of(cls, given: Mapping[str, Any]) -> "Found":
        """That of what a site.yaml holds."""
        entries = given.get("found") or {}
        body, trial = (entries.get(name) or {} for name in ("body", "trial"))
        return cls(**{
            **taken(cls, entries), "origin": Origin(**taken(Origin, entries.get("origin") or {})),
            "zones": tuple(map(zone, entries.get("zones") or ())),
            "body": Body(**taken(Body, body)) if "volume" in body else None,
            "bodies": {str(rank): SlipBody(**taken(SlipBody, one))
                       for rank, one in (entries.get("bodies") or {}).items()},
            "trial": Trial(**trial) if MEASURED <= set(trial) <= set(Trial._fields) else None,
            "down": frozen((entries.get("blocks") or {}).get("down") or ())})


def taken(kind: Any, entries: Mapping[str, Any]) -> Dict[str, Any]:
    """What a mapping has of the fields of a class; the others have their defaults."""
    return {one.name: frozen(entries[one.name]) for one in fields(kind) if entries.get(one.name) is not None}


def zone(entries: Mapping[str, Any]) -> Zone:
    own = {key: value for key, value in entries.items() if key not in ("name", "variables", "area_m2", "share")}
    return Zone(entries["name"], entries["variables"], own, entries.get("share", 0.0))
