!> The gas and a grain: one in rising gas, laminar flow between walls.
program verify_flow
  use communicator, only: communicator_t, start_ranks, stop_ranks
  use check, only: expect, finish
  use kinds, only: wp
  use laminar_flows, only: couette_error, drop, duct_error, duct_velocity, plates_drop, plates_error
  use lone_grain, only: balanced_slip, settled_velocity, transient_error
  use report, only: check_value
  use vortex_flow, only: decay
  implicit none

  type(communicator_t) :: comm

  call start_ranks(comm)
  call grain()
  call plates()
  call couette()
  call duct()
  call vortices()
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
    call plates_drop(comm, 32, worst, ok)
    call expect(ok, 'it converges')
    call check_value('plates_drop', worst, drop)
  end subroutine plates

  !> Plates of which one moves, on 8 to 64 cells, pushed on, left alone and held back.
  subroutine couette()
    real(wp) :: error(-1:1)
    integer :: level, m
    logical :: ok
    character(len=10) :: name

    do level = 3, 6
      do m = -1, 1
        call couette_error(comm, 2**level, 3.0_wp*m, error(m), ok)
        call expect(ok, 'it converges')
      end do
      write (name, '(a,i0)') 'couette_', 2**level
      call check_value(trim(name), maxval(error), 0.0_wp)
    end do
  end subroutine couette

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

  !> Orders in space, from 32 to 64 cells with the same steps, and in time, from 16 to 32 steps on the same cells.
  subroutine vortices()
    character(len=8), parameter :: limiters(2) = ['van_leer', 'central ']
    real(wp) :: error(2), a(2, 3)
    integer :: m, iterations(5)

    do m = 1, 2
      call decay(comm, 32, trim(limiters(m)), 0.5_wp, 10, error(1), a(:, 1), iterations(1))
      call decay(comm, 64, trim(limiters(m)), 0.5_wp, 10, error(2), a(:, 2), iterations(2))
      call expect(all(iterations(:2) > 0), 'all converge')
      call check_value('vortex_error_'//trim(limiters(m)), 100*error(2), 0.0_wp)
    end do
    call check_value('vortex_order_central', log(error(1)/error(2))/log(2.0_wp), 2.0_wp)
    do m = 1, 3
      call decay(comm, 32, 'van_leer', 0.8_wp, 8*2**m, error(1), a(:, m), iterations(m))
    end do
    call expect(all(iterations(:3) > 0), 'all converge')
    call check_value('vortex_order_time', log((a(1, 1) - a(1, 2))/(a(1, 2) - a(1, 3)))/log(2.0_wp), 1.0_wp)
    call check_value('vortex_decay', a(1, 3) + (a(1, 3) - a(1, 2)), a(2, 3))
  end subroutine vortices

end program verify_flow
