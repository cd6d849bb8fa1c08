# cmake -DSOURCE=FOLDER -DOUTPUT=FILE -P revision.cmake: writes a header that defines PLATOON_REVISION, if it changed.
execute_process(COMMAND git -C ${SOURCE} rev-parse --show-toplevel OUTPUT_VARIABLE root OUTPUT_STRIP_TRAILING_WHITESPACE
  ERROR_QUIET)
get_filename_component(source ${SOURCE} REALPATH)
set(revision "unknown")
if(root STREQUAL source)  # and not that of a workspace around it
  execute_process(COMMAND git -C ${SOURCE} describe --always --dirty --abbrev=12 OUTPUT_VARIABLE found
    OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET RESULT_VARIABLE failed)
  if(NOT failed)
    set(revision ${found})
  endif()
endif()
set(text "#define PLATOON_REVISION \"${revision}\"\n")
set(before "")
if(EXISTS ${OUTPUT})
  file(READ ${OUTPUT} before)
endif()
if(NOT text STREQUAL before)
  file(WRITE ${OUTPUT} "${text}")
endif()
