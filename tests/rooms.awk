# Rooms and their budgets of lines, for lines.sh and coverage.sh: room(PATH); room_name[1..room_count], room_budget[NAME].
function room(path, part) {
	if (path ~ /^ecofiles\/import\//) return "ecofiles/import"
	if (path ~ /^ecofiles\/(ecopack|generate)\//) return "ecofiles/ecopack, generate"
	if (path ~ /^ecofiles\//) return "ecofiles/base, format, scene"
	if (path ~ /^lod\/(plan|seen)\//) return "lod/plan, seen"
	if (path ~ /^(lod|server|client-min)\//) { split(path, part, "/"); return part[1] }
	return path ~ /^tests\/bench\// ? "tests/bench" : "tests without bench"
}
BEGIN {
	room_count = split("ecofiles/base, format, scene=16000|ecofiles/import=17000|ecofiles/ecopack, generate=13000|lod=19000|lod/plan, seen=9000|" \
		"server=8500|client-min=13000|tests without bench=38000|tests/bench=16000", room_name, "|")
	for (i = 1; i <= room_count; i++) {
		split(room_name[i], pair, "=")
		room_name[i] = pair[1]
		room_budget[pair[1]] = pair[2]
	}
}
