/* The code in the file BODY twice, in double and in single precision: it calls its numbers REAL, what it
   defines OF(name), and what executes a plan EXECUTE. */
#define REAL double
#define OF(name) name##_in_double
#define EXECUTE libraries.execute
#include BODY
#undef REAL
#undef OF
#undef EXECUTE
#define REAL float
#define OF(name) name##_in_single
#define EXECUTE libraries.execute_single
#include BODY
