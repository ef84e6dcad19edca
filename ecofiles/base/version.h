/* The version of all programs, which --version prints; it also stands in packs (META) and in the validators
 * of computed answers. */
#pragma once

#define ECO_VERSION "0.2"
