# For shell tests: nginx in the background, and a port that nobody has now.

free_port() {
	python3 -c 'import socket; s = socket.socket(); s.bind(("127.0.0.1", 0)); print(s.getsockname()[1])'
}

# nginx_start FOLDER TEXT: with all its files in FOLDER, an absolute path; TEXT stands in its http block. Sets $proxy.
nginx_start() {
	{
		[ "$(id -u)" -ne 0 ] || echo 'user root;'
		echo "daemon off; error_log $1/nginx.log; pid $1/nginx.pid; events {} http { access_log off;"
		for kind in client_body proxy fastcgi uwsgi scgi; do echo "${kind}_temp_path $1/temp_$kind;"; done
		echo "$2 }"
	} >"$1/nginx.conf"
	nginx -e "$1/nginx.log" -c "$1/nginx.conf" &
	proxy=$!
}
