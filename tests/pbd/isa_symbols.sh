#!/bin/sh
# usage: isa_symbols.sh NM NAMESPACE OBJECT... of a library
# What is compiled for an instruction set must share no name with what is compiled for all: the linker keeps one copy of each
# inline function, and might keep one that the processor at hand cannot run.
nm=$1 namespace=$2
shift 2
for isa in avx2 avx512; do
  symbols=$("$nm" -C "$@" 2>/dev/null | awk -v file="lanes_$isa.cpp.o" '/:$/ {inside = index($0, file)} inside') || exit 1
  [ -n "$symbols" ] || { echo "no lanes_$isa.cpp.o among the objects of $namespace"; exit 1; }
  shared=$(echo "$symbols" | grep -E ' [WVuB] ' | grep -v -e "$namespace::$isa::" -e DW.ref.__gxx_personality)
  [ -z "$shared" ] || { echo "lanes_$isa.cpp shares names with others:"; echo "$shared"; exit 1; }
done
