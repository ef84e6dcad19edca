#!/bin/sh
# server/openapi.yaml is a description by OpenAPI 3.0, by that specification's own schema; and one that is not is told apart. Prints what
# failed; status 0 when nothing did.
set -u
SCHEMA=/usr/share/openapi-specification/schemas/v3.0/schema.json
DIR=build/tmp/openapi-sh-$$
failed=0
mkdir -p "$DIR"
trap 'rm -rf "$DIR"' EXIT

complain() { echo "test_openapi: $*"; failed=1; }

tests/support/validate.py $SCHEMA server/openapi.yaml || complain "server/openapi.yaml is not valid"
spoiled() { # SED SAYS
	sed "$1" server/openapi.yaml >"$DIR/spoiled.yaml"
	tests/support/validate.py $SCHEMA "$DIR/spoiled.yaml" >"$DIR/out" && complain "valid even after $1"
	grep -q "$2" "$DIR/out" || complain "$1 gives: $(cat "$DIR/out")"
}
spoiled '0,/type: integer/s//type: whole/' 'whole'
spoiled '0,/^  title:/s//  titel:/' "'title' is a required property"
spoiled '0,/schemas.Problem"/s||schemas/Trouble"|' 'schemas/Trouble: leads nowhere'
exit $failed
