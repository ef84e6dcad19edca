#include "ecofiles/ecopack/command.h"

#include "ecofiles/ecopack/run.h"

bool main_is_quiet;

const struct eco_option main_common[] = {
	{ "quiet", 'q', ECO_OPTION_FLAG, NULL, &main_is_quiet, .help = "neither progress nor notes, only "
		"errors" }, { 0 } };

enum eco_code main_read(const struct main_command *command, int argc, char **argv, struct eco_error *error)
{
	enum eco_code code = eco_command_read(&command->line, argc, argv, error);
	main_progress_quiet(main_is_quiet);
	return code;
}
