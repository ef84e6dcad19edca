#ifndef ECO_MAIN_VERSION_H
#define ECO_MAIN_VERSION_H

#define ECO_VERSION "0.1"

#endif
