!> The gas and a grain: one in rising gas, laminar flow between walls.
program verify_flow
  use communicator, only: communicator_t, start_ranks, stop_ranks
  use check, only: expect, finish
  use kinds, only: wp
  use laminar_flows, only: duct_error, duct_velocity, plates_error
  use lone_grain, only: balanced_slip, settled_velocity, transient_error
  use report, only: check_value
  implicit none

  type(communicator_t) :: comm

  call start_ranks(comm)
  call grain()
  call plates()
  call duct()
  call finish()
  call stop_ranks()

contains

  !> The terminal velocity of a grain as of a heavy parcel, and the way there.
  subroutine grain()
    character(len=*), parameter :: laws(2) = ['gidaspow', 'beetstra']
    real(wp), parameter :: weights(2) = [1.0_wp, 1000.0_wp]
    real(wp) :: slip, worst
    integer :: law, w

    do law = 1, size(laws)
      slip = balanced_slip(1.0e-4_wp, 2000.0_wp, laws(law))
      worst = slip
      do w = 1, size(weights)
        associate (found => 0.3_wp - settled_velocity(comm, weights(w), laws(law)))
          if (abs(found - slip) >= abs(worst - slip)) worst = found
        end associate
      end do
      call check_value('terminal_'//laws(law), worst, slip)
    end do
    call check_value('transient_grain', 100*transient_error(comm, 1.0e-3_wp), 0.0_wp)
  end subroutine grain

  !> Plates on 8 to 64 cells.
  subroutine plates()
    real(wp) :: worst
    integer :: level
    logical :: ok
    character(len=9) :: name

    do level = 3, 6
      call plates_error(comm, 2**level, worst, ok)
      call expect(ok, 'it converges')
      write (name, '(a,i0)') 'plates_', 2**level
      call check_value(trim(name), worst, 0.0_wp)
    end do
  end subroutine plates

  !> The order of accuracy where the parabola at the wall is not exact.
  subroutine duct()
    real(wp) :: error(2)
    logical :: ok(2)

    call duct_error(comm, 32, error(1), ok(1))
    call duct_error(comm, 64, error(2), ok(2))
    call expect(all(ok), 'both converge')
    call check_value('duct_order', log(error(1)/error(2))/log(2.0_wp), 2.0_wp)
    call check_value('duct_error', 100*error(2)/duct_velocity(0.0_wp, 0.0_wp), 0.0_wp)
  end subroutine duct

end program verify_flow
