#!/bin/sh
# manual.sh PROGRAMS OUT: a manual page in OUT for each program in PROGRAMS, and for each command of ecopack, by help2man from what --help
# prints. $SOURCE_DATE_EPOCH dates them.
set -eu
programs=$1 out=$2
mkdir -p "$out"

# page NAME COMMAND...: help2man runs a script that gives the text its own words ("Usage", the page's name with the version)
page() {
	name=$1; shift
	script=$out/$name
	cat >"$script" <<-END
		#!/bin/sh
		case \$1 in
		--version) "$programs/$1" --version | sed 's/^[a-z]*/$name/' ;;
		*) "$programs"/$* --help | sed -e ':more' -e '1{N;/\n$/!{s/\n */ /;b more}}' -e 's/^usage:/Usage:/' ;;
		esac
	END
	chmod +x "$script"
	# the first sentence of its description, as a phrase
	says=$("$script" --help | sed '1,/^$/d; /^$/,$d' | tr '\n' ' ' | sed 's/\([;:]\|\. \|\.$\).*//')
	help2man --no-info --name="$(echo "$says" | sed 's/^[A-Z][a-z]/\l&/')" --output="$out/$name.1" "$script"
	rm "$script"
}

for program in ecopack ecoserve ecoview ecoload; do page $program $program; done
for command in $("$programs/ecopack" --help | sed -n 's/^  ecopack \([a-z]*\) .*/\1/p'); do page "ecopack-$command" ecopack "$command"; done
