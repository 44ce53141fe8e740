/* The code in the file BODY twice, in double and in single precision: it calls its numbers REAL, what it
   defines OF(name), and what executes a plan EXECUTE, one of another row than was planned TO_HALF and
   TO_ROW. */
#define REAL double
#define OF(name) name##_in_double
#define EXECUTE libraries.execute
#define TO_HALF libraries.to_half
#define TO_ROW libraries.to_row
#include BODY
#undef REAL
#undef OF
#undef EXECUTE
#undef TO_HALF
#undef TO_ROW
#define REAL float
#define OF(name) name##_in_single
#define EXECUTE libraries.execute_single
#define TO_HALF libraries.to_half_single
#define TO_ROW libraries.to_row_single
#include BODY
