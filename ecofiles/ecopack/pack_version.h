#ifndef ECO_PACK_VERSION_H
#define ECO_PACK_VERSION_H

#define ECO_VERSION "0.1"

#endif
