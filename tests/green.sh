# Part of run_one.sh and check.sh: which tests passed, with what they were then. $BUILD/tests/green/NAME holds the hash of a test's inputs
# when it last passed, and NAME.cpu the seconds of processor time that it took.
#
# A linker takes from an archive only what is called, so that a binary is the same, byte for byte, where nothing that it runs has changed:
# its bytes are the first input. The others: modules that it loads, and files, folders and programs that its source names in quotes. A
# script runs programs: all of them, and all scripts, are its inputs.
green_folder=$BUILD/tests/green

green_inputs() { # PROGRAM
	name=$(basename "$1")
	case $name in
	*.sh) find Makefile tests -name '*.sh' -o -name '*.txt' -o -name Makefile; find "$BUILD" "$BUILD/bench" -maxdepth 1 -type f -perm -u+x ;;
	fuzz_*) ls "$1" "$BUILD"/*.so; echo "tests/fuzz/corpus/${name#fuzz_}" ;;
	*)
		ls "$1" "$BUILD"/*.so
		for source in tests/*/"$name.c"; do
			grep -oE '"((tests|server)/[a-z0-9_./]+|ecofiles/[a-z/]+/words)"' "$source" | tr -d '"'
			grep -oE '/eco(pack|serve|view|load)"' "$source" | sed "s|^|$BUILD|; s|\"||"
		done
		;;
	esac 2>/dev/null | sort -u | while read -r input; do [ ! -e "$input" ] || echo "$input"; done
}

green_key() { # PROGRAM
	green_inputs "$1" | tr '\n' '\0' | xargs -0 -r -I {} find {} -type f | LC_ALL=C sort -u | tr '\n' '\0' | xargs -0 -r sha256sum | sha256sum
}

# Nothing is newer than the note, or it is and yet the same.
green_is() { # PROGRAM
	note=$green_folder/$(basename "$1")
	[ -e "$1" ] && [ -e "$note" ] || return 1
	[ -n "$(green_inputs "$1" | tr '\n' '\0' | xargs -0 -r -I {} find {} -newer "$note" | head -n 1)" ] || return 0
	[ "$(cat "$note")" = "$(green_key "$1")" ] || return 1
	touch "$note"
}

green_note() { # PROGRAM FAILED CPU KEY
	mkdir -p "$green_folder"
	echo "$3" >"$green_folder/$(basename "$1").cpu"
	if [ "$2" -eq 0 ]; then echo "$4" >"$green_folder/$(basename "$1")"; else rm -f "$green_folder/$(basename "$1")"; fi
}
