#include "server/request/address.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

#include "server/request/query.h"

static const uint8_t mapped[12] = { [10] = 0xff, [11] = 0xff };

static bool is_mapped(const struct srv_address *address)
{
	return memcmp(address->bytes, mapped, sizeof mapped) == 0;
}

struct srv_address srv_address_of(const struct sockaddr *at)
{
	struct srv_address address = { { 0 } };
	if (at->sa_family == AF_INET) {
		memcpy(address.bytes, mapped, sizeof mapped);
		memcpy(address.bytes + sizeof mapped,
			&((const struct sockaddr_in *)(const void *)at)->sin_addr, 4);
	} else if (at->sa_family == AF_INET6) {
		memcpy(address.bytes, &((const struct sockaddr_in6 *)(const void *)at)->sin6_addr, 16);
	}
	return address;
}

bool srv_address_parse(struct srv_address *address, const char *text, size_t size)
{
	char copy[SRV_ADDRESS_TEXT_BYTES];
	if (size >= sizeof copy)
		return false;
	memcpy(copy, text, size);
	copy[size] = 0;
	memcpy(address->bytes, mapped, sizeof mapped);
	return inet_pton(AF_INET, copy, address->bytes + sizeof mapped) == 1
		|| inet_pton(AF_INET6, copy, address->bytes) == 1;
}

void srv_address_format(char text[SRV_ADDRESS_TEXT_BYTES], const struct srv_address *address)
{
	bool v4 = is_mapped(address);
	if (!inet_ntop(v4 ? AF_INET : AF_INET6, address->bytes + (v4 ? sizeof mapped : 0), text,
			SRV_ADDRESS_TEXT_BYTES))
		snprintf(text, SRV_ADDRESS_TEXT_BYTES, "?");
}

bool srv_address_is_loopback(const struct srv_address *address)
{
	static const uint8_t v6[16] = { [15] = 1 };
	return (is_mapped(address) && address->bytes[12] == 127) || memcmp(address->bytes, v6, sizeof v6) == 0;
}

/* ":PORT", or nothing. */
static bool is_port(const char *text, size_t size)
{
	return size == 0 || srv_port_valid(text, size);
}

/* ADDRESS, IPv4:PORT, [IPv6] or [IPv6]:PORT. */
static bool parse_port(struct srv_address *address, const char *text, size_t size)
{
	const char *first = memchr(text, ':', size), *bracket = memchr(text, ']', size);
	size_t before = first ? (size_t)(first - text) : size;
	if (text[0] == '[')
		return bracket && memchr(text, ':', (size_t)(bracket - text))
			&& srv_address_parse(address, text + 1, (size_t)(bracket - text) - 1)
			&& is_port(bracket + 1, size - (size_t)(bracket + 1 - text));
	if (first && !memchr(first + 1, ':', size - before - 1))
		return srv_address_parse(address, text, before) && is_port(first, size - before);
	return srv_address_parse(address, text, size);
}

bool srv_host_is_loopback(const char *host)
{
	static const char name[] = "localhost";
	struct srv_address address;
	size_t size = strlen(host);
	if (strncasecmp(host, name, sizeof name - 1) == 0)
		return is_port(host + sizeof name - 1, size - (sizeof name - 1));
	return size && parse_port(&address, host, size) && srv_address_is_loopback(&address);
}

bool srv_address_same(const struct srv_address *a, const struct srv_address *b)
{
	return memcmp(a->bytes, b->bytes, is_mapped(a) ? 16 : 8) == 0;
}

static bool parse_network(struct srv_network *network, const char *text, size_t size)
{
	char digits[SRV_ADDRESS_TEXT_BYTES];
	const char *slash = memchr(text, '/', size);
	size_t before = slash ? (size_t)(slash - text) : size;
	uint64_t bits;
	if (!srv_address_parse(&network->address, text, before) || size - before >= sizeof digits)
		return false;
	uint32_t most = is_mapped(&network->address) ? 32 : 128;
	snprintf(digits, sizeof digits, "%.*s", slash ? (int)(size - before - 1) : 0, text + before + 1);
	if (slash ? !srv_parse_count(digits, &bits) || bits > most : !(bits = most))
		return false;
	network->bits = 128 - most + (uint32_t)bits;
	return true;
}

enum eco_code srv_networks_parse(const char *text, void *to, struct eco_error *error)
{
	struct srv_networks *networks = to;
	networks->count = 0;
	for (;; text++) {
		size_t size = strcspn(text, ",");
		if (networks->count == SRV_NETWORKS_MAX)
			return eco_fail(error, ECO_BAD_USAGE, "more than %u networks; give fewer, wider "
				"ones", SRV_NETWORKS_MAX);
		if (!parse_network(&networks->items[networks->count++], text, size))
			return eco_fail(error, ECO_BAD_USAGE,
				"'%.*s' is not an address, as 10.0.0.1 or ::1, with or "
				"without /BITS behind it",
				size > 60 ? 60 : (int)size, text);
		text += size;
		if (!*text)
			return ECO_OK;
	}
}

static bool contains(const struct srv_network *network, const struct srv_address *address)
{
	uint32_t whole = network->bits / 8, rest = network->bits % 8;
	return memcmp(network->address.bytes, address->bytes, whole) == 0 && (rest == 0
		|| (network->address.bytes[whole] ^ address->bytes[whole]) >> (8 - rest) == 0);
}

bool srv_networks_contain(const struct srv_networks *networks, const struct srv_address *address)
{
	for (uint32_t i = 0; i < networks->count; i++)
		if (contains(&networks->items[i], address))
			return true;
	return false;
}

struct srv_address srv_networks_client(const struct srv_networks *trusted, const struct srv_address *peer,
	const char *forwarded)
{
	struct srv_address client = *peer, next;
	const char *end = forwarded ? forwarded + strlen(forwarded) : NULL;
	while (end && end > forwarded && srv_networks_contain(trusted, &client)) {
		const char *first = end;
		while (first > forwarded && first[-1] != ',')
			first--;
		const char *text = first + strspn(first, " \t");
		size_t size = strcspn(text, ", \t");
		if (text >= end || !parse_port(&next, text, size))
			break;
		client = next;
		end = first > forwarded ? first - 1 : forwarded;
	}
	return client;
}
