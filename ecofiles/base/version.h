/* The version of all programs, which --version prints; it also stands in packs (META) and in the validators
 * of computed answers. */
#ifndef ECO_VERSION_H
#define ECO_VERSION_H

#define ECO_VERSION "0.2"

#endif
