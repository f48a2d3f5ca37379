!> The gas and its drag: laws against the values of other programs, one grain in rising gas, laminar flow between walls.
program verify_flow
  use communicator, only: communicator_t, start_ranks, stop_ranks
  use check, only: expect, finish
  use drag_beetstra, only: beetstra
  use drag_ergun, only: ergun
  use drag_gidaspow, only: gidaspow
  use drag_wen_yu, only: wen_yu
  use kinds, only: wp
  use laminar_flows, only: duct_error, duct_velocity, plates_error
  use lone_grain, only: balanced_slip, settled_velocity, transient_error
  use report, only: check_value
  implicit none

  type(communicator_t) :: comm

  call start_ranks(comm)
  call drag_laws()
  call fluidization()
  call grain()
  call plates()
  call duct()
  call finish()
  call stop_ranks()

contains

  !> F at (Re, eps) = (0.1, 0.95), (1, 0.85), (10, 0.60), (30, 0.45), (100, 0.75), (500, 0.40), the largest relative error.
  !> F of wen_yu and gidaspow agrees with MFIX 25.2.1 (drag_gs.f) to 1e-14, of beetstra with CFDEMcoupling-PFM
  !> (BeetstraDrag::F) to the last digit; ergun is the part of gidaspow at eps <= 0.8.
  subroutine drag_laws()
    real(wp), parameter :: reynolds(6) = [0.1_wp, 1.0_wp, 10.0_wp, 30.0_wp, 100.0_wp, 500.0_wp]
    real(wp), parameter :: eps(6) = [0.95_wp, 0.85_wp, 0.60_wp, 0.45_wp, 0.75_wp, 0.40_wp]

    call compare('wen_yu', wen_yu(reynolds, eps), [1.2430809516_wp, 2.0812236938_wp, 11.160825724_wp, 47.059136437_wp, &
                                                   12.999625034_wp, 332.26907944_wp])
    call compare('ergun', ergun(reynolds, eps), [0.47245306248_wp, 1.8646674356_wp, 11.959876543_wp, 37.037037037_wp, &
                                                 20.987654321_wp, 335.06944444_wp])
    call compare('gidaspow', gidaspow(reynolds, eps), [1.2430809516_wp, 2.0812236938_wp, 11.959876543_wp, 37.037037037_wp, &
                                                       20.987654321_wp, 335.06944444_wp])
    call compare('beetstra', beetstra(reynolds, eps), [1.7648954538_wp, 3.2804797786_wp, 13.464258242_wp, 39.509187022_wp, &
                                                       15.933314894_wp, 264.23076677_wp])
  end subroutine drag_laws

  subroutine compare(law, value, expected)
    character(len=*), intent(in) :: law
    real(wp), intent(in) :: value(6), expected(6)

    call check_value('drag_'//law, 100*maxval(abs(value/expected - 1)), 0.0_wp)
  end subroutine compare

  !> Minimum fluidization by a drag law, where it carries particles of 500 um and 2500 kg/m3 at a void fraction of 0.42 in
  !> air: 18 Re F = eps Ar, Ar = g rho (rho_p - rho) d^3/mu^2. The velocities expected were computed outside the program.
  subroutine fluidization()
    real(wp), parameter :: eps = 0.42_wp, d = 5.0e-4_wp, density = 1.2_wp, viscosity = 1.8e-5_wp
    real(wp), parameter :: archimedes = 9.81_wp*density*(2500 - density)*d**3/viscosity**2
    real(wp) :: low(2), high(2), re(2)
    integer :: i

    low = 0
    high = 1000
    do i = 1, 60
      re = (low + high)/2
      where (18*re*[gidaspow(re(1), eps), beetstra(re(2), eps)] < eps*archimedes)
        low = re
      elsewhere
        high = re
      end where
    end do
    call check_value('umf_gidaspow', re(1)*viscosity/(density*d), 0.2485206653_wp)
    call check_value('umf_beetstra', re(2)*viscosity/(density*d), 0.2263216658_wp)
  end subroutine fluidization

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
