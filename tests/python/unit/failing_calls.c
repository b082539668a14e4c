/* Calls of the system that fail when they are told to: preloaded by test_faults_injected.py, and steered through ctypes.

   Each call of a descriptor for data (sockets, pipes, terminals) is counted by its kind while somebody watches; the one
   that was armed fails with an error of choice and does nothing, but for close, which closes all the same, as Linux does.
   Pipes are left alone then: those who start processes close them. Threads that play the other end stand aside: theirs
   neither count nor fail. */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <stdatomic.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

enum { SOCKET, BIND, CONNECT, LISTEN, SETSOCKOPT, GETSOCKOPT, GETSOCKNAME, POLL, RECEIVE, SEND, ACCEPT, CLOSE, KINDS };

static atomic_int counts[KINDS], watching, armed_kind, armed_count, armed_error, failed;
static __thread int aside;

/* Begins to count; the `count`th call of a kind fails, 0 for none. */
void faults_begin(int kind, int count, int error)
{
    for (int one = 0; one < KINDS; one++)
        counts[one] = 0;
    armed_kind = kind;
    armed_count = count;
    armed_error = error;
    failed = 0;
    watching = 1;
}

/* Ends it; whether the call failed. */
int faults_end(void)
{
    watching = 0;
    return failed;
}

int faults_count(int kind) { return counts[kind]; }

void faults_stand_aside(int on) { aside = on; }

/* Whether a descriptor is a socket, a terminal, or with `pipes` a pipe. */
static int is_for_data(int descriptor, int pipes)
{
    struct stat status;
    int before = errno, known = descriptor > 2 && !fstat(descriptor, &status);
    errno = before;
    if (!known)
        return 0;
    /* 136 to 143 are the terminals of Unix98. */
    int terminal = S_ISCHR(status.st_mode) && (status.st_rdev >> 8 & 0xfff) / 8 == 17;
    return S_ISSOCK(status.st_mode) || (pipes && S_ISFIFO(status.st_mode)) || terminal;
}

static int fails(int kind, long descriptor)
{
    if (!watching || aside || (kind != SOCKET && kind != POLL && !is_for_data((int)descriptor, kind != CLOSE)))
        return 0;
    int count = atomic_fetch_add(&counts[kind], 1) + 1;
    if (kind != armed_kind || count != armed_count)
        return 0;
    failed = 1;
    errno = armed_error;
    return 1;
}

/* Arguments of these calls are numbers and pointers, which all travel in registers of their own. */
typedef long call(long, long, long, long, long, long);

#define REAL(name) \
    static call *real; \
    if (!real) \
        real = (call *)dlsym(RTLD_NEXT, #name)

#define FAILING(kind, name) \
    call failing_##name __asm__(#name); \
    long failing_##name(long a, long b, long c, long d, long e, long f) \
    { \
        REAL(name); \
        return fails(kind, a) ? -1 : real(a, b, c, d, e, f); \
    }

FAILING(SOCKET, socket)
FAILING(SOCKET, socketpair)
FAILING(BIND, bind)
FAILING(CONNECT, connect)
FAILING(LISTEN, listen)
FAILING(SETSOCKOPT, setsockopt)
FAILING(GETSOCKOPT, getsockopt)
FAILING(GETSOCKNAME, getsockname)
FAILING(POLL, poll)
FAILING(POLL, ppoll)
FAILING(POLL, epoll_wait)
FAILING(RECEIVE, read)
FAILING(RECEIVE, readv)
FAILING(RECEIVE, recv)
FAILING(RECEIVE, recvfrom)
FAILING(RECEIVE, recvmsg)
FAILING(RECEIVE, recvmmsg)
FAILING(SEND, write)
FAILING(SEND, writev)
FAILING(SEND, send)
FAILING(SEND, sendto)
FAILING(SEND, sendmsg)
FAILING(SEND, sendmmsg)
FAILING(ACCEPT, accept)
FAILING(ACCEPT, accept4)

call failing_close __asm__("close");
long failing_close(long a, long b, long c, long d, long e, long f)
{
    REAL(close);
    int fail = fails(CLOSE, a);
    long result = real(a, b, c, d, e, f);
    if (fail)
        errno = armed_error;
    return fail ? -1 : result;
}
