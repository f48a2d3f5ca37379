!> Every drag law at its limits; verification/verify_drag has it against the values of other programs.
program test_drag
  use check, only: expect, expect_close, finish
  use constants, only: pi
  use drag_beetstra, only: beetstra
  use drag_cello, only: cello
  use drag_di_felice, only: di_felice
  use drag_ergun, only: ergun
  use drag_gidaspow, only: gidaspow
  use drag_gidaspow_blend, only: gidaspow_blend
  use drag_koch_hill, only: koch_hill
  use drag_law, only: drag_law_t, new_drag_law, law_names
  use drag_syamlal_obrien, only: syamlal_obrien, continuous_d1
  use drag_tang, only: tang
  use drag_wen_yu, only: wen_yu
  use kinds, only: wp
  use sizes_beetstra, only: among_sizes_beetstra
  use sizes_cello, only: among_sizes_cello
  use sizes_yin_sundaresan, only: among_sizes_yin_sundaresan
  implicit none

  integer :: i

  call check_limits()
  call check_creeping()
  call check_rough_flow()
  call check_joints()
  call check_syamlal()
  do i = 1, size(law_names)
    call check_everywhere(trim(law_names(i)))
  end do
  call check_sizes()
  call finish()

contains

  !> One sphere in creeping flow feels Stokes drag, F = 1; Dalla Valle's has 4.8^2/24.
  subroutine check_limits()
    type(drag_law_t) :: law
    real(wp) :: stokes
    integer :: i

    do i = 1, size(law_names)
      select case (law_names(i))
      case ('ergun')
        stokes = 0.0_wp
      case ('syamlal_obrien', 'di_felice', 'rong')
        stokes = 0.96_wp
      case ('gidaspow_blend')
        stokes = 1 - atan(1/52.5_wp)/pi
      case default
        stokes = 1.0_wp
      end select
      law = new_drag_law(trim(law_names(i)))
      call expect_close(law%factor_at(0.0_wp, 1.0_wp), stokes, 1e-10_wp, trim(law_names(i))//' at Re = 0, eps = 1')
      call expect_close(law%factor_at(1.0e-3_wp, 1.0_wp + 1e-15_wp), law%factor_at(1.0e-3_wp, 1.0_wp), 1e-9_wp, &
                        trim(law_names(i))//': round-off above eps = 1 is no exception')
    end do
  end subroutine check_limits

  !> Creeping flow in a bed.
  subroutine check_creeping()
    call expect_close(beetstra(0.0_wp, 0.6_wp), 10*0.4_wp/0.36_wp + 0.36_wp*(1 + 1.5_wp*sqrt(0.4_wp)), 1e-15_wp, &
                      'beetstra in creeping flow')
    call expect_close(ergun(0.0_wp, 0.5_wp), 150.0_wp*0.5_wp/4.5_wp, 1e-15_wp, 'ergun in creeping flow')
    call expect_close(tang(0.0_wp, 0.6_wp), beetstra(0.0_wp, 0.6_wp), 1e-14_wp, 'tang in creeping flow is beetstra')
    call expect_close(koch_hill(0.0_wp, 0.5_wp), 10*0.5_wp/0.25_wp, 1e-14_wp, 'koch_hill in creeping flow')
    call expect_close(di_felice(0.0_wp, 0.5_wp), 0.96_wp*2.0_wp**3.7_wp, 1e-14_wp, 'di_felice in creeping flow')
    call expect_close(cello(0.0_wp, 0.5_wp), (1 + 25.6_wp + 28.6_wp)*4/10.9_wp, 1e-14_wp, 'cello in creeping flow')
  end subroutine check_creeping

  !> Above Re = 1000 the drag coefficient of a sphere, 24 F/Re, is 0.44; those of fits that end there change no more.
  subroutine check_rough_flow()
    call expect_close(24.0_wp/5000.0_wp*wen_yu(5000.0_wp, 1.0_wp), 0.44_wp, 1e-14_wp, 'wen_yu at Re = 5000')
    call expect_close(wen_yu(2000.0_wp, 0.9_wp), 0.44_wp*2000/24*0.9_wp**(-3.65_wp), 1e-14_wp, 'wen_yu at Re = 2000')
    call expect(wen_yu(1000.0_wp, 1.0_wp) > 18.25_wp, 'wen_yu at Re = 1000 is Schiller-Naumann')
    call expect_close(tang(4000.0_wp, 0.45_wp) - tang(0.0_wp, 0.45_wp), 4*(tang(1000.0_wp, 0.45_wp) - tang(0.0_wp, 0.45_wp)), &
                      1e-14_wp, 'tang at Re = 4000')
    call expect_close(cello(4000.0_wp, 0.45_wp) - cello(0.0_wp, 0.45_wp), &
                      4*(cello(1000.0_wp, 0.45_wp) - cello(0.0_wp, 0.45_wp)), 1e-14_wp, 'cello at Re = 4000')
  end subroutine check_rough_flow

  !> Laws made of two.
  subroutine check_joints()
    call expect_close(gidaspow(1.0_wp, 0.8_wp), ergun(1.0_wp, 0.8_wp), 0.0_wp, 'gidaspow at eps = 0.8 is ergun')
    call expect_close(gidaspow(1.0_wp, 0.81_wp), wen_yu(1.0_wp, 0.81_wp), 0.0_wp, 'gidaspow above 0.8 is wen_yu')
    call expect_close(gidaspow(1.0_wp, 0.8004_wp), wen_yu(1.0_wp, 0.8004_wp), 0.0_wp, 'gidaspow just above 0.8 is wen_yu')
    call expect_close(wen_yu(1000.5_wp, 1.0_wp), 0.44_wp*1000.5_wp/24, 1e-14_wp, 'wen_yu just above Re = 1000')
    call expect_close(cello(100.0_wp, 0.3_wp), 158.0694203922846_wp, 1e-12_wp, 'cello beyond close packing, computed elsewhere')
    call expect_close(gidaspow_blend(1.0_wp, 0.8_wp), 0.5_wp*(ergun(1.0_wp, 0.8_wp) + wen_yu(1.0_wp, 0.8_wp)), 1e-14_wp, &
                      'gidaspow_blend at eps = 0.8 is the mean of both')
    call expect_close(koch_hill(0.0_wp, 0.6_wp), 10*0.4_wp/0.36_wp, 1e-14_wp, 'koch_hill at eps = 0.6 is that of the dense')
    call expect_close(koch_hill(0.0_wp, 0.601_wp)/koch_hill(0.0_wp, 0.6_wp), 0.985_wp, 3e-3_wp, 'koch_hill jumps by 1 %')
  end subroutine check_joints

  !> Its constants: d_1 follows from c_1, and a smaller c_1 is a larger drag on the dense.
  subroutine check_syamlal()
    real(wp) :: d1, below, above

    call expect_close(continuous_d1(0.8_wp), 2.65_wp, 2e-3_wp, 'the d1 of c1 = 0.8')
    d1 = continuous_d1(0.28_wp)
    call expect_close(0.85_wp**d1, 0.28_wp*0.85_wp**1.28_wp, 1e-14_wp, 'the d1 of c1 = 0.28')
    below = syamlal_obrien(10.0_wp, 0.85_wp, 0.28_wp, d1)
    above = syamlal_obrien(10.0_wp, 0.85_wp + 1e-12_wp, 0.28_wp, d1)
    call expect_close(above, below, 1e-9_wp, 'syamlal_obrien does not jump with it')
    call expect(abs(syamlal_obrien(10.0_wp, 0.85_wp + 1e-12_wp, 0.28_wp, 2.65_wp)/below - 1) > 0.1_wp, 'and does without')
    call expect(syamlal_obrien(10.0_wp, 0.5_wp, 0.28_wp, d1) > syamlal_obrien(10.0_wp, 0.5_wp, 0.8_wp, 2.65_wp), &
                'syamlal_obrien grows as c1 falls')
    ! Without inertia V = A whatever the constants, at high speed V = B: the force on a sphere over B in the square.
    call expect_close(syamlal_obrien(0.0_wp, 0.5_wp, 0.3_wp, d1), 0.96_wp*2.0_wp**4.14_wp, 1e-14_wp, 'syamlal_obrien, creeping')
    call expect_close(syamlal_obrien(1.0e12_wp, 0.5_wp, 0.3_wp, d1), 0.63_wp**2/24*2.0e12_wp/(0.3_wp*0.5_wp**1.28_wp)**2, 1e-4_wp, &
                      'syamlal_obrien, fast')
  end subroutine check_syamlal

  !> At any speed and any void fraction a law gives a force that is a positive number and grows with the slip.
  subroutine check_everywhere(name)
    character(len=*), intent(in) :: name

    real(wp), parameter :: eps(15) = [0.05_wp, 0.1_wp, 0.2_wp, 0.3_wp, 0.36_wp, 0.4_wp, 0.5_wp, 0.6_wp, 0.7_wp, 0.79_wp, 0.81_wp, &
                                      0.9_wp, 0.99_wp, 1.0_wp, 1.0_wp + 1e-15_wp]
    type(drag_law_t) :: law
    real(wp) :: force, last
    integer :: e, k
    logical :: finite, grows

    law = new_drag_law(name)
    finite = .true.
    grows = .true.
    do e = 1, size(eps)
      last = 0.0_wp
      do k = -300, 70
        associate (reynolds => merge(0.0_wp, 10.0_wp**(0.1_wp*k), k == -300))
          force = law%factor_at(reynolds, eps(e))*reynolds
        end associate
        finite = finite .and. abs(force) < huge(force)
        grows = grows .and. (force > last .or. k == -300)
        last = force
      end do
    end do
    call expect(finite, name//' is finite')
    call expect(grows, name//' drags downstream, and the more the faster')
  end subroutine check_everywhere

  !> Particles among others: of one size, and where fits end.
  subroutine check_sizes()
    call expect_close(among_sizes_beetstra(7.0_wp, 1.0_wp), 1.064_wp*7, 1e-15_wp, 'one size, beetstra: 1.064')
    call expect_close(among_sizes_yin_sundaresan(7.0_wp, 0.5_wp, 1.0_wp), 7.0_wp, 1e-15_wp, 'one size, yin_sundaresan')
    call expect_close(among_sizes_cello(7.0_wp, 0.5_wp, 1.0_wp, 1.0_wp), 7.0_wp, 1e-15_wp, 'one size, cello')
    call expect_close(among_sizes_yin_sundaresan(7.0_wp, 1.0_wp, 2.0_wp), 1 + 6*2.0_wp, 1e-15_wp, 'alone, yin_sundaresan')
    call expect_close(among_sizes_cello(7.0_wp, 1.0_wp, 2.0_wp, 1.3_wp), 14.0_wp, 1e-15_wp, 'alone, cello')
    call expect_close(among_sizes_yin_sundaresan(100.0_wp, 0.3_wp, 0.1_wp), 10/3.0_wp + (100 - 10/3.0_wp)*0.01_wp, 1e-13_wp, &
                      'fines beyond close packing, yin_sundaresan')
    call expect_close(among_sizes_cello(100.0_wp, 0.3_wp, 0.01_wp, 1.0_wp), 0.1_wp, 1e-13_wp, 'fines beyond close packing, cello')
    call expect_close(among_sizes_cello(2.0_wp, 0.85_wp, 100.0_wp, 1.0_wp), 20.0_wp, 1e-13_wp, 'a boulder, cello')
  end subroutine check_sizes

end program test_drag
