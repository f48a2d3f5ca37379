!> Every drag law against the values of other programs at six points, and at its limits.
!>
!> The six columns are (Re, eps) = (0.1, 0.95), (1, 0.85), (10, 0.60), (30, 0.45), (100, 0.75), (500, 0.40).
!> F of wen_yu and gidaspow agrees with MFIX 25.2.1 (drag_gs.f) to 1e-14, of beetstra with CFDEMcoupling-PFM
!> (BeetstraDrag::F) to the last digit; ergun is the part of gidaspow at eps <= 0.8.
program test_drag
  use check, only: expect, expect_close, finish
  use drag_beetstra, only: beetstra
  use drag_ergun, only: ergun
  use drag_gidaspow, only: gidaspow
  use drag_wen_yu, only: wen_yu
  use kinds, only: wp
  implicit none

  real(wp), parameter :: reynolds(6) = [0.1_wp, 1.0_wp, 10.0_wp, 30.0_wp, 100.0_wp, 500.0_wp]
  real(wp), parameter :: eps(6) = [0.95_wp, 0.85_wp, 0.60_wp, 0.45_wp, 0.75_wp, 0.40_wp]
  real(wp), parameter :: tolerance = 1.0e-9_wp
  real(wp), parameter :: wen_yu_table(6) = [1.2430809516_wp, 2.0812236938_wp, 11.160825724_wp, 47.059136437_wp, &
    12.999625034_wp, 332.26907944_wp]
  real(wp), parameter :: ergun_table(6) = [0.47245306248_wp, 1.8646674356_wp, 11.959876543_wp, 37.037037037_wp, &
    20.987654321_wp, 335.06944444_wp]
  real(wp), parameter :: gidaspow_table(6) = [1.2430809516_wp, 2.0812236938_wp, 11.959876543_wp, 37.037037037_wp, &
    20.987654321_wp, 335.06944444_wp]
  real(wp), parameter :: beetstra_table(6) = [1.7648954538_wp, 3.2804797786_wp, 13.464258242_wp, 39.509187022_wp, &
    15.933314894_wp, 264.23076677_wp]

  call compare('wen_yu', wen_yu(reynolds, eps), wen_yu_table)
  call compare('ergun', ergun(reynolds, eps), ergun_table)
  call compare('gidaspow', gidaspow(reynolds, eps), gidaspow_table)
  call compare('beetstra', beetstra(reynolds, eps), beetstra_table)
  call check_limits()
  call check_rough_flow()
  call finish()

contains

  subroutine compare(law, value, expected)
    character(len=*), intent(in) :: law
    real(wp), intent(in) :: value(6), expected(6)

    integer :: i
    character(len=40) :: point

    do i = 1, 6
      write (point, '(2(a,f0.2),a)') ' at (', reynolds(i), ', ', eps(i), ')'
      call expect_close(value(i), expected(i), tolerance, law//trim(point))
    end do
  end subroutine compare

  !> One sphere in creeping flow feels Stokes drag, F = 1; creeping flow in a bed is finite.
  subroutine check_limits()
    call expect_close(wen_yu(0.0_wp, 1.0_wp), 1.0_wp, 1e-15_wp, 'wen_yu is Stokes drag at Re = 0, eps = 1')
    call expect_close(gidaspow(0.0_wp, 1.0_wp), 1.0_wp, 1e-15_wp, 'gidaspow is Stokes drag at Re = 0, eps = 1')
    call expect_close(beetstra(0.0_wp, 1.0_wp), 1.0_wp, 1e-15_wp, 'beetstra is Stokes drag at Re = 0, eps = 1')
    call expect_close(beetstra(0.0_wp, 0.6_wp), 10*0.4_wp/0.36_wp + 0.36_wp*(1 + 1.5_wp*sqrt(0.4_wp)), 1e-15_wp, &
      'beetstra in creeping flow')
    call expect_close(ergun(0.0_wp, 0.5_wp), 150.0_wp*0.5_wp/4.5_wp, 1e-15_wp, 'ergun in creeping flow')
    call expect_close(beetstra(1.0e-3_wp, 1.0_wp + 1e-15_wp), beetstra(1.0e-3_wp, 1.0_wp), 1e-9_wp, &
      'round-off above eps = 1 is no exception')
    call expect_close(gidaspow(1.0_wp, 0.8_wp), ergun(1.0_wp, 0.8_wp), 0.0_wp, 'gidaspow at eps = 0.8 is ergun')
    call expect_close(gidaspow(1.0_wp, 0.81_wp), wen_yu(1.0_wp, 0.81_wp), 0.0_wp, 'gidaspow above 0.8 is wen_yu')
  end subroutine check_limits

  !> Above Re = 1000 the drag coefficient of a sphere, 24 F/Re, is 0.44.
  subroutine check_rough_flow()
    call expect_close(24.0_wp/5000.0_wp*wen_yu(5000.0_wp, 1.0_wp), 0.44_wp, 1e-14_wp, 'wen_yu at Re = 5000')
    call expect_close(wen_yu(2000.0_wp, 0.9_wp), 0.44_wp*2000/24*0.9_wp**(-3.65_wp), 1e-14_wp, 'wen_yu at Re = 2000')
    call expect(wen_yu(1000.0_wp, 1.0_wp) > 18.25_wp, 'wen_yu at Re = 1000 is Schiller-Naumann')
  end subroutine check_rough_flow

end program test_drag
