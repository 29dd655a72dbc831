"""What a file must hold, as a JSON schema; what of it is wrong, in one line."""
import functools
from typing import Any, Dict, List, Mapping, Optional, Tuple

import yaml

from . import disk
from .errors import SlopeError

ANY: Dict[str, Any] = {}
NUMBER = {"type": "number"}             # finite
MAYBE = {"type": ["number", "null"]}
ABOVE_0 = {"type": "number", "exclusiveMinimum": 0}
COUNT = {"type": "integer", "minimum": 1}
TEXT, FLAG, OBJECT = {"type": "string"}, {"type": "boolean"}, {"type": "object"}
NTH = ("first", "second", "third", "fourth", "fifth", "sixth", "seventh", "eighth", "ninth", "tenth")
TYPES = {"array": "a list in brackets", "string": "a text", "number": "a finite number", "integer": "a whole number",
         "object": "a section with keys", "boolean": "true or false", "null": "null"}
RULES = {"exclusiveMinimum": "be > {}", "minimum": "be >= {}", "exclusiveMaximum": "be < {}", "maximum": "be <= {}",
         "enum": "be one of {}", "minItems": "have at least {} items", "maxItems": "have at most {} items"}


def number_keys(*names: str) -> Dict[str, Any]:
    return dict.fromkeys(names, NUMBER)


def mapping(required: Mapping[str, Any], null: bool = False, **optional: Any) -> Dict[str, Any]:
    """Of a mapping with these keys, or of none; it may have others."""
    return {"type": ["object", "null"] if null else "object", "required": list(required),
            "properties": {**required, **optional}}


def dict_of(items: Mapping[str, Any], least: int = 0) -> Dict[str, Any]:
    """Of a mapping whose keys are names, and whose values are all alike."""
    return {"type": "object", "additionalProperties": items, "minProperties": least}


def list_of(items: Mapping[str, Any], least: int = 0, null: bool = False) -> Dict[str, Any]:
    return {"type": ["array", "null"] if null else "array", "items": items, "minItems": least}


FINDINGS = list_of({**OBJECT, "description": "findings"}, null=True)
NO_OTHERS = "must have no"      # as the rule on keys that are unknown begins


def load_checked(path, what: str, schema: Mapping[str, Any]) -> Any:
    """What a YAML file holds; SlopeError unless it fits the schema. what: the file, for messages."""
    about = disk.parse_yaml(path, what)
    check_schema(about, schema, path, what)
    return about


def check_schema(value: Any, schema: Mapping[str, Any], where, what: str) -> None:
    """Raise SlopeError unless a value fits the schema."""
    wrong = first_error(value, schema)
    if wrong:
        place = [nth(part) if isinstance(part, int) else str(part) for part in wrong[0]]
        raise SlopeError(where, ": ".join([f"must be {what}", *place, wrong[1]]))


@functools.lru_cache
def validator():
    """jsonschema's, to whom numbers are finite, and keys of any type; imported when it is needed."""
    import jsonschema
    latest = jsonschema.Draft202012Validator

    def additional(checker, allowed, instance, schema):
        if allowed is not False:
            yield from latest.VALIDATORS["additionalProperties"](checker, allowed, instance, schema)
        elif isinstance(instance, dict) and instance.keys() - schema["properties"].keys():
            yield jsonschema.ValidationError("other keys")      # jsonschema's own words sort them, numbers beside text

    return jsonschema.validators.extend(
        latest, {"additionalProperties": additional},
        type_checker=latest.TYPE_CHECKER.redefine("number", lambda _, value: disk.is_finite_number(value)))


def first_error(value: Any, schema: Mapping[str, Any]) -> Optional[Tuple[List[Any], str]]:
    """Keys (texts) and indices of the first place that does not fit, and the rule; None if all does."""
    errors = sorted(validator()(schema).iter_errors(value), key=lambda error: [str(part) for part
                                                                               in error.absolute_path])
    if not errors:
        return None
    place: List[Any] = []
    for part in errors[0].absolute_path:
        place.append(part if isinstance(value, list) else str(part))
        value = value[part]
    return place, rule_of(errors[0])


def nth(index: int) -> str:
    """The place of a list's item in words."""
    return f"{NTH[index] if index < len(NTH) else f'{index + 1}th'} value"


def find_yaml_number(value: Any) -> Optional[str]:
    """How YAML has the number that a text is meant to be: 1.2e1, which is a text to it, or one in quotes; else None."""
    try:
        number = float(value) if isinstance(value, str) and "_" not in value else None
    except ValueError:
        return None
    return yaml.safe_dump(number).split()[0] if disk.is_finite_number(number) else None


def rule_of(error) -> str:
    """What a ValidationError of jsonschema says, as a rule."""
    rule, value, got = str(error.validator), error.validator_value, repr(error.instance)[:60]
    if rule == "additionalProperties":
        extra = sorted(map(str, error.instance.keys() - error.schema["properties"].keys()))
        return f"{NO_OTHERS} {', '.join(extra)}, which is unknown; keys are {', '.join(error.schema['properties'])}"
    if rule == "required":
        return f"must have {' and '.join(key for key in value if key not in error.instance)}"
    if rule == "type":
        types = value if isinstance(value, list) else [value]
        example = f", such as [{got}]" if "array" in types and disk.is_finite_number(error.instance) else ""
        if "number" in types and (meant := find_yaml_number(error.instance)):
            example = f" (as {meant}; YAML takes it for a text)"
        return f"must be {' or '.join(TYPES.get(one, one) for one in types)}{example}, got {got}"
    if rule == "anyOf" and "description" in error.schema:
        return f"must have {error.schema['description']}, got {got}"
    if rule.startswith("min") and value == 1 and rule != "minimum":
        return "must not be empty"
    if rule in RULES:
        return f"must {RULES[rule].format(', '.join(map(str, value)) if isinstance(value, list) else value)}, got {got}"
    return f"must be valid: {error.message}"
