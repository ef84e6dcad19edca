/* What --version prints, and part of the validators of computed answers. */
#ifndef SRV_VERSION_H
#define SRV_VERSION_H

#define SRV_VERSION "ecostream 0.1"

#endif
