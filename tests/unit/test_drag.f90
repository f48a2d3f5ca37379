!> Every drag law at its limits; verification/verify_flow has it against the values of other programs.
program test_drag
  use check, only: expect, expect_close, finish
  use drag_beetstra, only: beetstra
  use drag_ergun, only: ergun
  use drag_gidaspow, only: gidaspow
  use drag_wen_yu, only: wen_yu
  use kinds, only: wp
  implicit none

  call check_limits()
  call check_rough_flow()
  call finish()

contains

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
