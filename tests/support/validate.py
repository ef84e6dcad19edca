#!/usr/bin/python3
"""validate.py SCHEMA.json DOCUMENT...: says what of each document, JSON or YAML, the JSON Schema does not allow, and which of
its references lead nowhere. A line an error: FILE: PATH: TEXT. Status 1 if there is any. (Debian's python3-jsonschema,
python3-yaml)"""
import json
import sys

import jsonschema
import yaml


def read(path):
    with open(path, encoding="utf-8-sig") as file:
        return yaml.safe_load(file) if path.endswith(".yaml") else json.load(file)


def references(node):
    if isinstance(node, dict):
        if isinstance(node.get("$ref"), str):
            yield node["$ref"]
        node = list(node.values())
    for item in node if isinstance(node, list) else []:
        yield from references(item)


def leads_nowhere(document, reference):
    try:
        jsonschema.RefResolver("", document).resolve(reference)
        return False
    except jsonschema.RefResolutionError:
        return True


def faults(document, validator):
    for error in validator.iter_errors(document):
        yield "%s: %s" % ("/".join(map(str, error.absolute_path)) or "the document", error.message[:300])
    for reference in references(document):
        if leads_nowhere(document, reference):
            yield "%s: leads nowhere" % reference


def main(schema_path, *paths):
    schema = read(schema_path)
    kind = jsonschema.validators.validator_for(schema)
    kind.check_schema(schema)
    found = 0
    for path in paths:
        try:
            told = list(faults(read(path), kind(schema)))
        except ValueError as error:
            told = ["the document: %s" % error]
        for text in told:
            print("%s: %s" % (path, text))
        found += len(told)
    return found > 0


sys.exit(main(*sys.argv[1:]))
