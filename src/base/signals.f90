!> Requests from outside to stop: signals, and the exit code that answers them.
!>
!> A batch system sends USR1 or TERM some time before it kills a job, a person at a terminal INT (Ctrl-C).
!> The time loop looks at `caught_signal` once a step, so a run always stops between two steps.
module signals
  use, intrinsic :: iso_c_binding, only: c_int, c_funptr, c_funloc, c_null_funptr
  implicit none
  private
  public :: catch_signals, caught_signal, signal_name, quit

  ! Numbers as on Linux.
  integer(c_int), parameter :: interrupt = 2, user_1 = 10, user_2 = 12, terminate = 15

  ! The one module variable of the program: a handler has no other way to tell what it saw.
  integer(c_int), volatile, bind(C, name='geldart_caught_signal') :: caught = 0

  interface
    function c_signal(number, handler) result(previous) bind(C, name='signal')
      import :: c_int, c_funptr
      implicit none
      integer(c_int), value :: number
      type(c_funptr), value :: handler
      type(c_funptr) :: previous
    end function c_signal

    subroutine c_exit(code) bind(C, name='exit')
      import :: c_int
      implicit none
      integer(c_int), value :: code
    end subroutine c_exit
  end interface

contains

  !> From now on the four signals are noted instead of ending the program.
  subroutine catch_signals()
    integer(c_int), parameter :: numbers(4) = [interrupt, user_1, user_2, terminate]

    type(c_funptr) :: previous
    integer :: i

    do i = 1, size(numbers)
      previous = c_signal(numbers(i), c_funloc(note_signal))
    end do
  end subroutine catch_signals

  !> The handler. It may do next to nothing; a second Ctrl-C ends the program at once.
  subroutine note_signal(number) bind(C)
    integer(c_int), value :: number

    type(c_funptr) :: previous

    caught = number
    if (number == interrupt) previous = c_signal(interrupt, c_null_funptr)
  end subroutine note_signal

  !> The last signal caught on this rank, 0 if there was none.
  function caught_signal() result(number)
    integer :: number

    number = int(caught)
  end function caught_signal

  pure function signal_name(number) result(name)
    integer, intent(in) :: number
    character(len=:), allocatable :: name

    select case (number)
    case (interrupt)
      name = 'INT'
    case (user_1)
      name = 'USR1'
    case (user_2)
      name = 'USR2'
    case (terminate)
      name = 'TERM'
    case default
      name = 'unknown'
    end select
  end function signal_name

  !> End this process with an exit code; all its files must be closed and MPI stopped.
  subroutine quit(code)
    integer, intent(in) :: code

    call c_exit(int(code, c_int))
  end subroutine quit

end module signals
