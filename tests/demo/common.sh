# Shared by demo.sh and forest.sh: start a daemon on a free port, stop it, put figures and pictures on one page.
# BUILD is the folder of the programs.

# finished plants are kept with the other output, not in the user's own cache
export XDG_CACHE_HOME="$PWD/build/cache"

die() { echo "$0: $*" >&2; exit 1; }

# serve LOG PACK... : starts ecoserve, sets SERVER_PID and BASE (http://127.0.0.1:PORT)
serve() {
	log=$1; shift
	: >"$log"                # looked at before the daemon's shell may have opened it
	"$BUILD/ecoserve" --listen 127.0.0.1:0 "$@" >"$log" 2>"$log.err" &
	SERVER_PID=$!
	trap 'kill $SERVER_PID 2>/dev/null' EXIT
	for _ in $(seq 100); do
		BASE=$(sed -n 's/.*ready on \(http:[^ ]*\).*/\1/p' "$log")
		[ -n "$BASE" ] && return
		kill -0 $SERVER_PID 2>/dev/null || die "ecoserve ended: $(cat "$log.err")"
		sleep 0.1
	done
	die "ecoserve did not become ready; see $log.err"
}

stop_serving() {
	kill $SERVER_PID 2>/dev/null
	wait $SERVER_PID 2>/dev/null
	trap - EXIT
}

# page OUT.html TITLE INTRO SUMMARY.json DIR... : one row of pictures a frame
page() {
	out=$1 title=$2 intro=$3 summary=$4; shift 4
	{
		cat <<-HTML
		<!doctype html><html lang="en"><meta charset="utf-8"><title>$title</title>
		<style>
		body{font:15px/1.5 system-ui,sans-serif;margin:2rem auto;max-width:1500px;padding:0 1rem;color:#222;background:#fafaf7}
		h1{font-size:1.5rem} h2{font-size:1.15rem;margin-top:2rem} img{width:100%;display:block;border-radius:4px}
		.row{display:grid;grid-template-columns:repeat(3,1fr);gap:.6rem;margin:.4rem 0 1.2rem}
		.row p,figure{margin:0} figcaption{font-size:.8rem;color:#666}
		table{border-collapse:collapse;font-size:.9rem} td,th{padding:.15rem .7rem;text-align:right;border-bottom:1px solid #ddd}
		</style><h1>$title</h1><p>$intro</p>
		<p>Left: streamed within the budget. Middle: every triangle. Right: the score of the covered pixels: light what is
		right, orange what is too much, blue what is missing. Precision is the share of what is drawn that is right, Recall the share
		of what should be drawn that is, Q both in one, skill what Q wins over covering everything, owner Q asks for the right plant, too; soft Q
		looks at how much of each pixel is covered, and the ceiling is the Q of a picture that only misses what single samples hit by chance.
		1 is the full scene. The picture error is what people see of the difference (FLIP) to the truth: full detail, 64 samples a pixel; m16 and
		s16 are differences of colour and of contrast in blocks of 16 x 16 pixels. 0 is the truth.</p>
		HTML
		for dir in "$@"; do
			name=$(basename "$dir")
			echo "<h2>$name</h2><table><tr><th>frame<th>vertices<th>of<th>bytes<th>Precision<th>Recall<th>Q<th>skill<th>owner Q<th>soft Q<th>ceiling<th>picture error<th>m16<th>s16</tr>"
			jq -r 'def r: if . == null then "–" else (. * 1000 | round / 1000 | tostring) end;
				.frames[] | "<tr><td>\(.frame)<td>\(.vertices)<td>\(.budget_vertices)<td>\(.bytes)<td>\(.precision|r)<td>\(.recall|r)<td>\(.q|r)<td>\(.skill|r)<td>\(.owner_q|r)<td>\(.soft_q|r)<td>\(.ceiling|r)<td>\(.picture_error|r)<td>\(.m16|r)<td>\(.s16|r)</tr>"' "$dir/report.json"
			echo "</table>"
			for frame in "$dir"/frame-[0-9][0-9][0-9][0-9].png; do
				n=$(basename "$frame" .png); n=${n#frame-}
				echo '<div class="row">'
				for kind in frame reference pr; do
					[ -f "$dir/$kind-$n.png" ] && echo "<figure><img src=\"$name/$kind-$n.png\" alt=\"$kind $n\"><figcaption>$kind-$n.png</figcaption></figure>"
				done
				echo '</div>'
			done
		done
		[ ! -f "$(dirname "$out")/map.png" ] ||
			echo '<h2>Where everything stands (ecopack map)</h2><img src="map.png" alt="map">'
		echo "<h2>Figures</h2><pre>"; jq . "$summary"; echo "</pre></html>"
	} >"$out.tmp-$$" && mv "$out.tmp-$$" "$out"
}

# frame_lines DIR : one PR line per frame
frame_lines() {
	jq -r --arg name "$(basename "$1")" 'def r: if . == null then "-" else (. * 10000 | round / 10000 | tostring) end;
		.frames[] | "\($name) frame \(.frame): \(.vertices)/\(.budget_vertices) vertices, \(.bytes) bytes, P \(.precision|r) R \(.recall|r) Q \(.q|r) skill \(.skill|r) owner_q \(.owner_q|r) soft_q \(.soft_q|r) picture_error \(.picture_error|r) m16 \(.m16|r) s16 \(.s16|r)"' "$1/report.json"
}
