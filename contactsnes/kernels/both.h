/* The code in the file BODY twice, in double and in single precision: it calls its numbers REAL, what it
   defines OF(name), what executes a plan EXECUTE, one of other rows than were planned EXECUTE_ROWS, TO_HALF and
   TO_ROW,
   and what tells whether that may be ALIGNMENT_OF. */
#define REAL double
#define OF(name) name##_in_double
#define EXECUTE libraries.execute
#define EXECUTE_ROWS libraries.execute_rows
#define TO_HALF libraries.to_half
#define TO_ROW libraries.to_row
#define ALIGNMENT_OF libraries.alignment
#include BODY
#undef REAL
#undef OF
#undef EXECUTE
#undef EXECUTE_ROWS
#undef TO_HALF
#undef TO_ROW
#undef ALIGNMENT_OF
#define REAL float
#define OF(name) name##_in_single
#define EXECUTE libraries.execute_single
#define EXECUTE_ROWS libraries.execute_rows_single
#define TO_HALF libraries.to_half_single
#define TO_ROW libraries.to_row_single
#define ALIGNMENT_OF libraries.alignment_single
#include BODY
