/* A client: an address, and those that count as one with it. An IPv4 address stands for itself; of
 * IPv6 a whole /64 does, since that is what one household gets.
 *
 * A proxy that is trusted speaks for others: the last address of X-Forwarded-For that is no trusted proxy's
 * is the client. The header of anyone else is not looked at. */
#pragma once

#include <stdbool.h>
#include <stdint.h>
#include <sys/socket.h>

#include "ecofiles/base/status.h"

struct srv_address { uint8_t bytes[16]; };       /* IPv6; IPv4 as ::ffff:a.b.c.d; all zero: not known */
#define SRV_ADDRESS_TEXT_BYTES 48

struct srv_address srv_address_of(const struct sockaddr *at);
bool srv_address_parse(struct srv_address *address, const char *text, size_t size);
void srv_address_format(char text[SRV_ADDRESS_TEXT_BYTES], const struct srv_address *address);
bool srv_address_is_loopback(const struct srv_address *address);
/* Whether a Host header's value is "localhost" or a loopback address, with or without a port: no name that
 * somebody else may lead here. */
bool srv_host_is_loopback(const char *host);
/* Do both count as one client? */
bool srv_address_same(const struct srv_address *a, const struct srv_address *b);

#define SRV_NETWORKS_MAX 64u
struct srv_network { struct srv_address address; uint32_t bits; };       /* bits of 128 */
struct srv_networks { struct srv_network items[SRV_NETWORKS_MAX]; uint32_t count; };

/* A reader of options (struct eco_option) for a struct srv_networks: "ADDRESS[/BITS],..."; ECO_BAD_USAGE
 * names what is none. */
enum eco_code srv_networks_parse(const char *text, void *networks, struct eco_error *error);
bool srv_networks_contain(const struct srv_networks *networks, const struct srv_address *address);
/* The client behind `peer`. `forwarded`: the values of all X-Forwarded-For lines, in order, with commas
 * between them; or NULL. */
struct srv_address srv_networks_client(const struct srv_networks *trusted, const struct srv_address *peer,
	const char *forwarded);
