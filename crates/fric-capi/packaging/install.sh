#!/usr/bin/env bash
# Puts libfric where C and C++ find it: headers, libraries, CMake package, pkg-config file.
# Usage: install.sh LIBRARIES    with PREFIX and, for packages, DESTDIR in the environment; LIBRARIES is where cargo left them.
set -euo pipefail
package=$(cd "$(dirname "$0")/.." && pwd)
libraries=$1
prefix=${PREFIX:-/usr/local}
case $prefix in /*) ;; *) echo "PREFIX is '$prefix'; it must be an absolute path, for example PREFIX=\"\$PWD/dist\"" >&2; exit 2 ;; esac
root=${DESTDIR:-}$prefix
version=$(sed -n 's/^version = "\(.*\)"/\1/p' "$package/../../Cargo.toml" | head -1)
abi=$(sed -n 's/^#define FRIC_ABI_VERSION //p' "$package/include/fric.h")

licences=$root/share/licenses/fric
install -d "$licences" "$root/include" "$root/lib/pkgconfig" "$root/lib/cmake/fric"
install -m 644 "$package/include/fric.h" "$package/include/fric.hpp" "$root/include"
install -m 644 "$package"/../../{LICENSE,LICENSE-APACHE,LICENSE-MIT,THIRD-PARTY.txt} "$licences"
install -m 644 "$libraries/libfric.a" "$root/lib"
install -m 755 "$libraries/libfric.so" "$root/lib/libfric.so.$version"
ln -sf "libfric.so.$version" "$root/lib/libfric.so.$abi"
ln -sf "libfric.so.$abi" "$root/lib/libfric.so"
for file in fric.pc:pkgconfig fric-config.cmake:cmake/fric fric-config-version.cmake:cmake/fric; do
    name=${file%%:*} folder=$root/lib/${file#*:}
    sed -e "s/@VERSION@/$version/g" -e "s/@ABI@/$abi/g" "$package/packaging/$name" > "$folder/$name"
    chmod 644 "$folder/$name"
done
echo "fric $version is in $root"
