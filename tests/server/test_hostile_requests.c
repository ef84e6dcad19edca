/* Requests over raw sockets that no friendly client sends, and what exactly comes back: how many answers,
 * which, and whether the connection is closed behind them. Each is sent at once, and byte by byte. */
#include "tests/support/serve/serve_daemon.h"

#include <netinet/tcp.h>

#define LINE "GET /healthz HTTP/1.1\r\n"
#define GET LINE HOST
#define SECOND GET "\r\n"
#define A10 "aaaaaaaaaa"
#define A100 A10 A10 A10 A10 A10 A10 A10 A10 A10 A10
#define A1000 A100 A100 A100 A100 A100 A100 A100 A100 A100 A100
#define A9000 A1000 A1000 A1000 A1000 A1000 A1000 A1000 A1000 A1000
#define X10 "X: \r\nX: \r\nX: \r\nX: \r\nX: \r\nX: \r\nX: \r\nX: \r\nX: \r\nX: \r\n"
#define C10 "a=b; a=b; a=b; a=b; a=b; a=b; a=b; a=b; a=b; a=b; "

#define BYTES(text) text, sizeof(text) - 1

/* `answers`: statuses in order; a full stop where the connection is closed behind the last. */
struct hostile_row { const char *request; size_t size; const char *answers; };

static const struct hostile_row rows[] = {
	/* what is legal stays so */
	{ BYTES(GET "\r\n"), "200" },
	{ BYTES("\r\n" GET "\r\n"), "200" },
	{ BYTES(LINE "Host:t\r\n\r\n"), "200" },
	{ BYTES(GET X10 X10 X10 X10 X10 "\r\n"), "200" },
	{ BYTES(GET "X: " A1000 A1000 A1000 A1000 A1000 A1000 "\r\n\r\n"), "200" },
	{ BYTES("GET /healthz HTTP/1.0\r\nConnection: keep-alive\r\n\r\n"), "200" },
	{ BYTES(SECOND "\r\n" SECOND), "200 200" },
	{ BYTES("HEAD /healthz HTTP/1.1\r\n" HOST "\r\n"), "200" },
	{ BYTES(STREAM "Content-Length: 4\r\n\r\n\0\0\0\0" SECOND), "200 200" },
	{ BYTES(STREAM "Content-Length:  4\r\n\r\n\0\0\0\0\r\n" SECOND), "200 200" },
	{ BYTES(STREAM "Expect: 100-continue\r\nContent-Length: 4\r\n\r\n\0\0\0\0" SECOND), "100 200 200" },
	/* request lines */
	{ BYTES(" " GET "\r\n"), "400." },
	{ BYTES("\r\n\r\n" GET "\r\n"), "400." },
	{ BYTES("\n" GET "\r\n"), "400." },
	{ BYTES("get /healthz HTTP/1.1\r\n" HOST "\r\n"), "400." },
	{ BYTES("GET  /healthz HTTP/1.1\r\n" HOST "\r\n"), "400." },
	{ BYTES("GET /healthz\r\n"), "400." },
	{ BYTES("PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n"), "505." },
	{ BYTES("GET /healthz HTTP/1.1\n" HOST "\r\n"), "400." },
	{ BYTES("GET /healthz HTTP/1.1\r" HOST "\r\n"), "400." },
	{ BYTES("AAAAAAAAAABBBBBBBBBBAAAAAAAAAABBBBBBBBBB / HTTP/1.1\r\n" HOST "\r\n"), "400." },
	{ BYTES("GET /" A1000 A1000 A1000 " HTTP/1.1\r\n" HOST "\r\n"), "414." },
	{ BYTES("GET /" A9000 " HTTP/1.1\r\n" HOST "\r\n"), "414." },
	/* hosts */
	{ BYTES(LINE "\r\n"), "400." },
	{ BYTES(GET HOST "\r\n"), "400." },
	/* headers */
	{ BYTES(GET "X: 1\n\r\n"), "400." },
	{ BYTES(GET "X: 1\r\n\n"), "400." },
	{ BYTES(GET "X: " A9000 "\r\n\r\n"), "431." },
	{ BYTES(GET X10 X10 X10 X10 X10 X10 X10 X10 X10 X10 "\r\n"), "431." },
	{ BYTES(GET "Cookie: " C10 C10 C10 C10 C10 C10 C10 C10 C10 C10 C10 C10 C10 C10 C10 C10 C10 C10 C10 C10
		    "\r\n\r\n"), "431." },
	/* where a request ends */
	{ BYTES(GET "\0X: 1\r\n\r\n" SECOND), "400." },
	{ BYTES(GET "X: 1\0\r\n\r\n" SECOND), "400." },
	{ BYTES(LINE "Host:t\r\n: x\r\n\r\n" SECOND), "400." },
	{ BYTES(STREAM "Content-Length: 0\0...37\r\n\r\n" SECOND), "400." },
	{ BYTES(STREAM "Content-Length: 4\0\r\n\r\n\0\0\0\0" SECOND), "400." },
	{ BYTES(STREAM "Content-Length: 4\r\nTransfer-Encoding: chunked\r\n\r\n0\r\n\r\n" SECOND), "400." },
	{ BYTES(STREAM "Transfer-Encoding: chunked\r\nContent-Length: 4\r\n\r\n0\r\n\r\n" SECOND), "400." },
	{ BYTES(STREAM "Transfer-Encoding: chunked\r\n\r\n4\r\nabcd\r\n0\r\n\r\n" SECOND), "400." },
	{ BYTES(STREAM "\r\n" SECOND), "411." },
	{ BYTES(GET "Content-Length: 4\r\n\r\n" SECOND), "400." },
	{ BYTES(STREAM "Content-Length: 5\r\n\r\n\0\0\0\0\0" SECOND), "400 200" },
	{ BYTES(STREAM "Content-Length: 0\r\n\r\n" SECOND), "400 200" },
	{ BYTES(STREAM "Content_Length: 4\r\n\r\nabcd" SECOND), "411." },
	{ BYTES(LINE "Host: " A100 A100 A10 A10 A10 A10 A10 "aaaaa\r\n\r\n"), "200" },
	{ BYTES(LINE "Host: " A100 A100 A10 A10 A10 A10 A10 "aaaaaa\r\n\r\n"), "400." },
	{ BYTES("SSH-2.0-x\r\n\r\n"), "400." },
	{ BYTES(SECOND "\0" SECOND), "200 400." },
	{ BYTES(SECOND "G" SECOND), "200 405" },
	{ BYTES(SECOND GET ": x\r\n\r\n" SECOND), "200 400." },
	{ BYTES(STREAM "Content-Length: 4\r\n\r\n\0\0\0\0\0" SECOND), "200 400." },
};

#define HOSTILE_VALUES 120
/* Requests place by place: each value between two texts. `after` may hold zeros. */
struct hostile_group {
	const char *before;
	struct { const char *bytes; size_t size; } after;
	const char *answers, *values[HOSTILE_VALUES + 1];
};
#define AFTER(text) { text, sizeof(text) - 1 }

static const struct hostile_group hostile_groups[] = {
	{ "", AFTER(" /healthz HTTP/1.1\r\nHost: t\r\n\r\n"), "400.", { "G\200ET", "G\377ET", "Get", "GET:",
		"GE(T", "GE,T", "G/T", "\"GET\"", "", "GET http://t" } },
	{ LINE, AFTER("\r\n\r\n"), "400.", { "H\200ost: t", "H\377ost: t", "Host : t", "Host\t: t",
		"HOST: t\r\nHost: t", "host:t\r\nX: 1\r\nHost: t", "Host:\r\n t", "Host:: t", ":Host: t",
		"Host", "Host t", "H ost: t", "Host=t", "\tHost: t", " \r\nHost: t" } },
	{ GET, AFTER("\r\n\r\n"), "200", { "X: \200", "X: \377", "Accept: */*\r\naccept: */*",
		"Accept-Encoding: gzip\r\naccept-encoding: gzip", "Origin: http://a\r\norigin: http://a",
		"X: 1\r\nx: 1", "Cookie: a=b\r\ncookie: a=b", "User-Agent: a\r\nuser-agent: a",
		"Referer: a\r\nreferer: a", "Connection: keep-alive\r\nconnection: keep-alive",
		"Connection: x", "Connection:", "Connection: Upgrade\r\nUpgrade: websocket",
		"Connection: Upgrade, HTTP2-Settings\r\nUpgrade: h2c\r\nHTTP2-Settings: AAMAAABkAARAAAAAAAIAAAAA",
		"Upgrade: TLS/1.0", "TE: trailers", "Trailer: X", "Max-Forwards: 0",
		"Proxy-Connection: close", "Keep-Alive: timeout=0", "Forwarded: for=1.2.3.4",
		"X-Forwarded-For: 1.2.3.4", "X-Forwarded-Host: a..b", "X-HTTP-Method-Override: DELETE",
		"X-Original-URL: /metrics", "X-Rewrite-URL: /metrics", "If-None-Match: \"",
		"If-None-Match: a", "If-None-Match: W/", "If-Match: *", "If-Modified-Since: x",
		"If-Unmodified-Since: Thu, 01 Jan 1970 00:00:00 GMT", "Range: bytes=", "Range: bytes=1-0",
		"Range: bytes=-", "Range: bytes=0-0,0-0", "Range: bytes=99-", "Range: lines=0-",
		"Accept: x", "Accept-Encoding: \"", "Content-Encoding: gzip", "Content-MD5: a", "Date: x",
		"Via: 1.1 t", "X: ", "X: a:b \x80\xff\tc", "Content-Length: 0" } },
	{ GET, AFTER("\r\n\r\n" SECOND), "400.", { "X\"y: 1", "X(y: 1", "X)y: 1", "X,y: 1", "X/y: 1", "X;y: 1",
		"X<y: 1", "X=y: 1", "X>y: 1", "X?y: 1", "X@y: 1", "X[y: 1", "X\\y: 1", "X]y: 1", "X{y: 1",
		"X}y: 1", "X y: 1", "X\ty: 1", "Content-Length: 0\r\nContent-Length: 0",
		"Content-Length: x", "Content-Length: -1", "Transfer-Encoding: chunked\r\n\r\n0" } },
	{ "", AFTER(" /healthz HTTP/1.1\r\nHost: t\r\n\r\n"), "405", { "PUT", "PATCH", "TRACE", "PROPFIND", "POST",
		"M-SEARCH", "QUERY" } },
	{ "", AFTER(" /healthz HTTP/1.1\r\nHost: t\r\n\r\n"), "204", { "OPTIONS" } },
	{ "GET /healthz ", AFTER("\r\nHost: t\r\n\r\n"), "400.", { "HTTP/1", "HTTP/1.", "HTTP/.1", "HTTP/1.1.1",
		"HTTP/1.01", "HTTP/-1.1", "HTTP/+1.1", "HTTP/1.9", "HTTPS/1.1", "ICY/1.1", "HTTP /1.1",
		"HTTP/ 1.1", "HTTP/1 .1", "HTTP/1,1", "HTTP\\1.1", "Http/1.1", "HTTP/1.1;", "1.1", "/1.1",
		"HTTP", "HTTP/1.1 HTTP/1.1", "HTTP/1.1\r", "HTTP/1.2" } },
	{ "GET /healthz ", AFTER("\r\nHost: t\r\n\r\n"), "505.", { "HTTP/01.1", "HTTP/3.0", "HTTP/9.9", "HTTP/0.0",
		"HTTP/0.1", "HTTP/00001.1", "HTTP/0.9", "HTTP/2.0" } },
	{ "GET ", AFTER(" HTTP/1.1\r\nHost: t\r\n\r\n"), "400.", { "/./healthz", "/healthz/", "/healthz/.",
		"/healthz/..", "/a/../healthz", "/%2e/healthz", "/%2e%2e/healthz", "/%2E%2E%2Fhealthz",
		"/healthz%2f", "/%68ealthz", "/healthz%20", "/healthz%0d%0a", "/healthz%0d%0aX:1",
		"/healthz%7f", "/healthz%80", "/%c0%af", "/%c0%ae%c0%ae/", "/%u0068", "/%", "/%a", "/%a%",
		"/%g1", "/%00", "/healthz;a", "/healthz;/..", "/healthz\\", "/\\..\\healthz", "/healthz|",
		"/healthz\"", "/<healthz>", "/{healthz}", "/^", "/`", "/healthz??", "/healthz?a",
		"/healthz?=", "/healthz?a=1&a=1", "/healthz?%", "/healthz?a=%zz", "/healthz?a=%00",
		"/healthz?a#b", "/healthz##", "#", "/v1/scenes/../healthz", "/v1//scenes",
		"/v1/scenes/%73ample", "/v1/scenes/sample%2fplan", "/v1/scenes/sample/", "/v1/scenes/.",
		"/v1/scenes/sample/chunks/..", "/.git/config", "/cgi-bin/../../etc/passwd", ".", "..",
		"../", "./healthz", "?", "mailto:a", "http:healthz", "http:/t/healthz", "http:///",
		"http://t", "http://t?", "http://t#", "http://t/healthz?", "http://t/healthz#",
		"http://:80/healthz", "http://t:65536/healthz", "http://t:-1/healthz",
		"http://t:8o/healthz", "http://t:80:80/healthz", "http://@t/healthz",
		"http://a%40b/healthz", "http://t\\@u/healthz", "http://t\t/healthz",
		"http://[::1]x/healthz", "http://[::1]:x/healthz", "http://[]/healthz",
		"http://[v1.a]/healthz", "http://[fe80::1%25eth0]/healthz", "http://::1/healthz",
		"http://.t/healthz", "http://t..u/healthz", "http://t,u/healthz", "http://t%2e/healthz",
		"HTTP://t/healthz", "hTtP://t/healthz", "https://t/healthz", "ws://t/healthz",
		"file:///healthz", "//t/healthz", "///healthz", "*/healthz", "t:80", "*", "/healthz?",
		"/healthz?&&&&&&&&&&&&&&&&&&&&&&&&&&&&&&&&", "http://t:99999/healthz" } },
	{ "GET ", AFTER(" HTTP/1.1\r\nHost: t\r\n\r\n"), "400", { "/healthz?a=b" } },
	{ "GET ", AFTER(" HTTP/1.1\r\nHost: t\r\n\r\n"), "404", { "/v1/scenes/SAMPLE",
		"/v1/scenes/sample/chunks/0", "/etc/passwd" } },
	{ "GET ", AFTER(" HTTP/1.1\r\nHost: t\r\n\r\n"), "200", { "http://t:/healthz", "http://t:0/healthz",
		"http://[::1]/healthz", "http://t./healthz", "http://t/healthz" } },
	{ LINE "Host: ", AFTER("\r\n\r\n"), "400.", { "t u", "t\tu", "t;u", "t#", "t%41", "t%", "t|u", "t\"", "t'",
		"t<u>", "t{u}", "t^", "t`", "t!", "t$", "t&", "t*", "t+", "t=", "t(", "t:+80", "t:-1",
		"t:8o", "t:80a", "t:1.2", "::1", "::", "[::1]:99999", "[::1]:x", "[::1]]", "[[::1]]",
		"[g::1]", "[::1%eth0]", "[fe80::1%25eth0]", "[v1.a]", "[ ::1]", ".t", "t..", "..",
		"http://t", "t/", "/t", "t?x", "t@u", "u:p@t", "t,t", "t t", "\"t\"", "*", "t\200",
		"\303\251", "a@b", "a:65536" } },
	{ LINE "Host: ", AFTER("\r\n\r\n"), "200", { "t~u", "t:0", "t:00080", "t:80 ", "t:080", "[::1]:",
		"[::1]:0", "[:::]", "[1:2:3]", "[1::2::3]", "[1.2.3.4]", "1.2.3.4", "1.2.3.4:80",
		"999.1.1.1", "1.2.3", "0x7f.1", "-t", "t-", "t.-u", "t.", "-", "_", "localhost",
		"xn--a", "t:80", "[2001:db8::1.2.3.4]:80" } },
	{ GET, AFTER("\r\n\r\n"), "400.", { " Host: u", "X: 1\r", "X: 1\n Y: 2", "X: \r1", "\rX: 1", "X\r: 1",
		"X: 1\r\n ", "X: 1\r\n\t", " ", "\t", "  X: 1", "X: 1\r\n  Content-Length: 4",
		"Content-Type: application/octet-stream\r\ncontent-type: application/octet-stream",
		"Range: bytes=0-\r\nrange: bytes=0-", "If-None-Match: *\r\nif-none-match: *",
		"If-Match: *\r\nif-match: *", "If-Modified-Since: x\r\nif-modified-since: x",
		"If-Range: \"a\"\r\nif-range: \"a\"", "Authorization: Bearer a\r\nauthorization: Bearer a",
		"Expect: 100-continue\r\nexpect: 100-continue", "Expect: 100-continue", "Expect: 200-ok",
		"Expect:", "Expect: 100-continue, x", "Host: u", ": x", "X", "X : 1", "X: 1\r\n 2",
		"X: \x01", "If-None-Match: \"a\"\r\nIf-None-Match: \"b\"",
		"Range: bytes=0-0\r\nRange: bytes=0-0", "If-Range: a\r\nIf-Range: a",
		":\r\nGET /healthz HTTP/1.1\r\nHost:t" } },
	{ "", AFTER(SECOND), "400.", { "\r", "\r\r\n", "\n\n", " \r\n", "\t", "\r\n\r\n\r\n", "\357\273\277",
		"PROXY TCP4 1.2.3.4 1.2.3.4 1 2\r\n",
		"HEAD /healthz HTTP/1.1\r\n" HOST "Content-Length: 4\r\n\r\n",
		"HEAD /healthz HTTP/1.1\r\n" HOST "Content-Length: 0\r\nContent-Length: 0\r\n\r\n",
		"HEAD /healthz HTTP/1.1\r\n" HOST "Content-Length: x\r\n\r\n",
		"HEAD /healthz HTTP/1.1\r\n" HOST "Content-Length: -1\r\n\r\n",
		"DELETE /healthz HTTP/1.1\r\n" HOST "Content-Length: x\r\n\r\n",
		"DELETE /healthz HTTP/1.1\r\n" HOST "Content-Length: -1\r\n\r\n",
		"GET /healthz HTTP/1.0\r\n" HOST "Transfer-Encoding: chunked\r\n\r\n0\r\n\r\n",
		"GET /healthz HTTP/1.0\r\n" HOST "Expect: 100-continue\r\n\r\n" } },
	{ STREAM "Content-Length:", AFTER("\r\n\r\n\0\0\0\0" SECOND), "400.", { " 4 ", " 4\t", " 4.0", " 4e0",
		" 4,", " 4,4", " ,4", " 4;4", " 4 5", " 4\013", " \0134", " -0", " +0", " 0x0", " 0 4",
		" four", " \262", " 999999999999999999999999999999", " 18446744073709551616",
		" 18446744073709551620", " 4194304 4", " '4'", " \"4\"", " (4)", " 4\r\n Content-Length: 5",
		" 4\r\nContent-Length: 04", " 4\r\ncontent-length: 4",
		" 4\r\nX: 1\r\nContent-Length: 0" } },
	{ STREAM "Content-Length:", AFTER("\r\n\r\n\0\0\0\0" SECOND), "200 200", { "  4", " 04", "4" } },
	{ STREAM "Content-Length:", AFTER("\r\n\r\n\0\0\0\0" SECOND), "400 400.", { " 0", " 00" } },
	{ STREAM "Content-Length:", AFTER("\r\n\r\n\0\0\0\0" SECOND), "413.", { " 18446744073709551615",
		" 4294967300", " 9223372036854775807" } },
	{ GET, AFTER("\r\n\r\n" SECOND), "200 200", { "Content-Length: 00" } },
	{ "", AFTER(SECOND), "200 200", { "HEAD /healthz HTTP/1.1\r\n" HOST "Content-Length: 00\r\n\r\n",
		"GET /healthz HTTP/1.0\r\n" HOST "Connection: keep-alive\r\n\r\n",
		"HEAD /healthz HTTP/1.1\r\n" HOST "Content-Length: 0\r\n\r\n" } },
	{ "", AFTER(SECOND), "405.", { "DELETE /healthz HTTP/1.1\r\n" HOST "Content-Length: 4\r\n\r\n" } },
	{ "", AFTER(SECOND), "405 200", { "DELETE /healthz HTTP/1.1\r\n" HOST "Content-Length: 00\r\n\r\n",
		"DELETE /healthz HTTP/1.1\r\n" HOST "\r\n" } },
	{ STREAM "Transfer-Encoding:", AFTER("\r\n\r\n0\r\n\r\n" SECOND), "400.", { " chunked", " Chunked",
		" CHUNKED", "  chunked", " chunked ", " chunked\t", " \tchunked", " chunked, chunked",
		" chunked,identity", " identity, chunked", " gzip, chunked", " gzip", " deflate", " x", " ",
		" chunked;a=b", " \"chunked\"", " 'chunked'", " chunk", " chunkedx", " xchunked",
		" c hunked", " chunked,", " chunked\r\nTransfer-Encoding: chunked",
		" gzip\r\nTransfer-Encoding: chunked", " identity\r\nContent-Length: 4",
		" chunked\r\n Content-Length: 4", "chunked" } },
	{ STREAM, AFTER("\r\n\r\n0\r\n\r\n" SECOND), "400.", { "TRANSFER-ENCODING: chunked", "Transfer-Encoding",
		"Transfer-Encoding=chunked", "X: 1\r\nTransfer-Encoding: chunked",
		"Transfer-Encoding\r\n: chunked" } },
	{ STREAM, AFTER("\r\n\r\n0\r\n\r\n" SECOND), "411.", { "Transfer_Encoding: chunked" } },
	{ GET, AFTER("\r\n\r\n"), "200.", { "Connection: close, keep-alive", "Connection: Close",
		"Connection: close\r\nConnection: keep-alive" } },
	{ GET, AFTER("\r\n\r\n"), "412", { "If-Match: \"a\"" } },
	{ "", AFTER(SECOND), "200.", { "GET /healthz HTTP/1.0\r\n" HOST "Connection: close\r\n\r\n" } },
	{ "", AFTER(SECOND), "404 200", { "GET /nowhere HTTP/1.1\r\n" HOST "\r\n",
		"HEAD /nowhere HTTP/1.1\r\n" HOST "\r\n" } },
	{ GET, AFTER("\r\n\r\n" SECOND), "200 400.", { "\r\nGET /healthz HTTP/1.1", "\r\n" } },
	{ GET, AFTER("\r\n\r\n"), "200 200 400.", {
		"\r\nGET /healthz HTTP/1.1\r\nHost: t\r\n\r\nXXXXXXXXXXXXXXXXXXXXXXXXXXXXXXXXXXXXXXXX" } },
	{ STREAM "Content-Length:", AFTER("\r\n\r\n\0\0\0\0" SECOND), "200.", { " 4\r\nConnection: close" } },
	{ "GET /healthz ", AFTER("\r\nHost: t\r\n\r\n"), "200.", { "HTTP/1.0" } },
	{ STREAM "Content-Length: ", AFTER("\r\n\r\nabcd" SECOND), "400.", { "4\r\nContent-Length: 4",
		"4, 4", "+4", "4 " } },
	{ STREAM "Content-Length: ", AFTER("\r\n\r\nabcd" SECOND), "413.", { "9223372036854775808",
		"4194305" } },
	{ STREAM "Content-Length: ", AFTER("\r\n\r\nabcd" SECOND), "400 200", { "4" } },
};

/* All that comes until the end. */
static char *read_all(int fd, size_t *size)
{
	size_t room = 1 << 16;
	char *bytes = malloc(room + 1);
	*size = 0;
	for (ssize_t got; (got = recv(fd, bytes + *size, room - *size, 0)) > 0;)
		if ((*size += (size_t)got) == room)
			bytes = realloc(bytes, (room *= 2) + 1);
	bytes[*size] = 0;
	return bytes;
}

/* The statuses of the answers, one after the other as their lengths say; "?" where something is no answer. */
static void list_answers(char *list, size_t room, const char *bytes, size_t size, bool is_head)
{
	size_t used = 0;
	*list = 0;
	for (const char *at = bytes; at < bytes + size && used + 8 < room; is_head = false) {
		const char *end = strstr(at, "\r\n\r\n"), *length = strcasestr(at, "\r\nContent-Length: ");
		unsigned status = strncmp(at, "HTTP/1.", 7) == 0 && end ? (unsigned)atoi(at + 9) : 0;
		used += (size_t)snprintf(list + used, room - used, status ? "%s%u" : "%s?", used ? " " : "",
			status);
		if (!status)
			return;
		bool none = is_head || status == 100 || status == 304 || !length || length > end;
		at = end + 4 + (none ? 0 : strtoul(length + 18, NULL, 10));
	}
}

static bool asks_head(const char *request)
{
	return strncmp(request, "HEAD ", 5) == 0;
}

/* Sends the request and, if the server took it for well, one that closes; its answer is dropped from the
 * list. */
static void ask(char list[256], const struct hostile_row *row, bool byte_by_byte)
{
	static const char last[] = "GET /healthz HTTP/1.1\r\nHost: last\r\nConnection: close\r\n\r\n";
	int fd = http_connect(port), on = 1;
	size_t size;
	setsockopt(fd, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
	bool sent = true;
	for (size_t i = 0; i < row->size && sent; i += byte_by_byte ? 1 : row->size)
		sent = http_send(fd, row->request + i, byte_by_byte ? 1 : row->size);
	bool open = !strchr(row->answers, '.');
	if (open)
		http_send(fd, last, sizeof last - 1);
	char *bytes = read_all(fd, &size);
	list_answers(list, 250, bytes, size, asks_head(row->request));
	size_t used = strlen(list);
	if (open && used >= 4 && strcmp(list + used - 4, " 200") == 0)
		list[used - 4] = 0;
	else
		strcat(list, ".");
	free(bytes);
	close(fd);
}

/* Whether the row was answered otherwise. */
static bool is_wrong(const struct hostile_row *row)
{
	char list[256];
	bool wrong = false;
	for (int byte_by_byte = 0; byte_by_byte < 2; byte_by_byte++) {
		ask(list, row, byte_by_byte);
		if (strcmp(list, row->answers) == 0)
			continue;
		print_error("%s: %s, not %s: %s\n", byte_by_byte ? "byte by byte" : "at once", list,
			row->answers, row->request);
		wrong = true;
	}
	return wrong;
}

UNIT_TEST(each_request_gets_exactly_its_answers)
{
	unsigned wrong = 0;
	for (size_t i = 0; i < sizeof rows / sizeof *rows; i++)
		wrong += is_wrong(&rows[i]);
	assert_int_equal(wrong, 0);
}

UNIT_TEST(each_place_of_a_request_is_held_to_the_grammar)
{
	char request[1024];
	unsigned wrong = 0;
	for (size_t i = 0; i < sizeof hostile_groups / sizeof *hostile_groups; i++) {
		const struct hostile_group *group = &hostile_groups[i];
		for (const char *const *value = group->values; *value; value++) {
			size_t size = (size_t)snprintf(request, sizeof request, "%s%s", group->before, *value);
			assert_true(size + group->after.size < sizeof request);
			memcpy(request + size, group->after.bytes, group->after.size + 1);
			wrong += is_wrong(&(struct hostile_row){ request, size + group->after.size, group->answers });
		}
	}
	assert_int_equal(wrong, 0);
}

/* A byte that belongs nowhere, at every place of a request (but its end): one refusal, and the end. */
UNIT_TEST(a_control_character_anywhere_is_refused)
{
	static const char request[] = LINE "Host: t\r\nAccept: */*\r\nX-Y:z\r\n\r\n";
	char list[256], made[sizeof request + 1];
	for (size_t at = 0; at < sizeof request - 2; at++)
		for (char bad = 0; bad <= ' '; bad++) {
			if (bad == '\t')
				continue;        /* belongs into values */
			memcpy(made, request, at);
			made[at] = bad < ' ' ? bad : 0x7f;
			memcpy(made + at + 1, request + at, sizeof request - at);
			const struct hostile_row row = { made, sizeof request, "400." };
			ask(list, &row, false);
			if (strcmp(list, "400.") != 0)
				fail_msg("byte %u before offset %zu: %s", (unsigned)made[at], at, list);
		}
}

/* Heads of every size and kind up to the limits and beyond: well, or refused by a problem document; never by
 * what the library says when its memory runs out. */
UNIT_TEST(large_heads_are_served_or_refused_well)
{
	static char head[32768];
	unsigned served = 0, refused = 0;
	for (int headers = 0; headers <= 98; headers += 14)
		for (int cookies = 0; cookies <= 160; cookies += 32)
			for (int fill = 0; fill <= 8000; fill += 400) {
				int size = sprintf(head, GET "Connection: close\r\nX: %0*d\r\nCookie: ", fill,
					0);
				for (int i = 0; i < cookies; i++)
					size += sprintf(head + size, "a=b;");
				for (int i = 0; i < headers; i++)
					size += sprintf(head + size, "\r\nX-%d: a", i);
				size += sprintf(head + size, "\r\n\r\n");
				struct http_answer answer = http_raw(port, head, (size_t)size);
				bool is_large = answer.status == 431 && strstr(answer.body, "head-too-large");
				if (answer.status != 200 && !is_large)
					fail_msg("%d headers, %d cookies, %d filled: %s", headers, cookies,
						fill, answer.head);
				served += answer.status == 200;
				refused += is_large;
				http_free(&answer);
			}
	assert_true(served > 300 && refused > 300);
}

UNIT_MAIN(serve_start, serve_stop)
