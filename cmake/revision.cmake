# Run with -P at every build: writes OUTPUT from TEMPLATE with GONOGO_VERSION and the git revision of SOURCE.
# configure_file leaves the file alone when nothing changed, so only a new revision costs a compilation. Sources outside of a
# repository (a copy on another machine, a package) may name theirs by the environment variable GONOGO_REVISION.
execute_process(
  COMMAND git -C "${SOURCE}" describe --always --dirty --abbrev=12 --exclude=*
  OUTPUT_VARIABLE GONOGO_REVISION OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET RESULT_VARIABLE status)
if(NOT status EQUAL 0 OR GONOGO_REVISION STREQUAL "")
  set(GONOGO_REVISION unknown)
  if(NOT "$ENV{GONOGO_REVISION}" STREQUAL "")
    set(GONOGO_REVISION "$ENV{GONOGO_REVISION}")
  endif()
endif()
configure_file("${TEMPLATE}" "${OUTPUT}" @ONLY)
