# Completion of ecopack, ecoserve, ecoview and ecoload: commands and options as --help names them, and files.
_ecostream()
{
	local cur prev words cword
	_init_completion -n = || return
	local command=
	if [[ ${1##*/} == ecopack ]]; then
		command=${words[1]}
		if ((cword == 1)) && [[ $cur != -* ]]; then
			COMPREPLY=($(compgen -W "$("$1" --help 2>/dev/null | sed -n 's/^  ecopack \([a-z]*\) .*/\1/p')" -- "$cur"))
			return
		fi
	fi
	if [[ ${1##*/} == ecopack && $command == generate && $cword -eq 2 && $cur != -* ]]; then
		COMPREPLY=($(compgen -W "$("$1" --help 2>/dev/null | sed -n '/^Scenes to generate/,/^$/s/^      \([a-z]\+\) .*/\1/p')" -- "$cur"))
	elif [[ $cur == -* ]]; then
		COMPREPLY=($(compgen -W "$("$1" ${command:+"$command"} --help 2>/dev/null | grep -oE '^ +(-[a-zA-Z], )?--[a-z-]+' | grep -oE -- '-[a-zA-Z]\b|--[a-z-]+')" -- "$cur"))
	else
		_filedir
	fi
} &&
	complete -F _ecostream ecopack ecoserve ecoview ecoload
