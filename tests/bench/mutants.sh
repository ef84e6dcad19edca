# mutate DIR COUNT SEED: so many damaged models, of generated plants in five formats, through the importer. BUILD is the folder of the
# programs.
mutate() {
	dir=$1 count=$2 seed=$3
	rm -rf "$dir"; mkdir -p "$dir"
	"$BUILD/ecopack" generate park -o "$dir/park" >"$dir/log" 2>&1 || { cat "$dir/log"; return 1; }
	set -- "$dir/park/models/grass.obj"
	for format in ply dae fbx glb; do
		"$BUILD/bench/convert" "$dir/park/models/poppy.obj" "$dir/poppy.$format"
		set -- "$@" "$dir/poppy.$format"
	done
	"$BUILD/bench/mutants" --count "$count" --seed "$seed" "$@"
}
