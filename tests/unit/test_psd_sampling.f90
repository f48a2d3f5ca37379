!> A thousand parcels carry the powder: its means to 0.1 %, its mass to half a parcel.
program test_psd_sampling
  use check, only: expect, expect_close, finish
  use constants, only: pi, unset
  use kinds, only: wp
  use outcome, only: outcome_t
  use powder_settings, only: powder_settings_t
  use sampling, only: draw_number, draw_mass, mean_parcel_mass
  use size_audit, only: size_summary_t, summary_asked, summary_made
  use size_distribution, only: size_distribution_t, new_size_distribution
  use weighting, only: weighting_t
  implicit none

  real(wp), parameter :: um = 1.0e-6_wp
  type(weighting_t) :: weightings(4)
  character(len=*), parameter :: names(4) = [character(len=16) :: 'SSW', 'SSP', 'theta = 0.5', 'theta = 0.3']

  weightings = [weighting_t(27.0_wp, 1.0_wp, 0.0_wp), weighting_t(1.0_wp, 1552.6_wp*um, 1.0_wp), &
                weighting_t(27.0_wp, 500*um, 0.5_wp), weighting_t(27.0_wp, 500*um, 0.3_wp)]
  call audit_by_hand()
  call audit_of_powder()
  call means_of_a_thousand()
  call drawing_by_number_is_wrong()
  call mass_to_half_a_parcel()
  call tables()
  call finish()

contains

  !> Glass beads of 500 and 125 um by number, cut to 250-800 um.
  function beads() result(sizes)
    type(size_distribution_t) :: sizes

    type(powder_settings_t) :: powder
    type(outcome_t) :: outcome

    powder%distribution = 'log_normal'
    powder%mean_diameter = 500*um
    powder%standard_deviation = 125*um
    powder%minimum_diameter = 250*um
    powder%maximum_diameter = 800*um
    call new_size_distribution(powder, sizes, outcome)
    call expect(.not. outcome%failed(), 'the beads are accepted')
  end function beads

  !> Three sizes, of which 2, 1 and 1 parcels with weights 4, 2 and 1: masses 8, 16 and 27 volumes of the unit.
  subroutine audit_by_hand()
    type(size_summary_t) :: made

    made = summary_made([3.0_wp, 1.0_wp, 2.0_wp, 1.0_wp], [1.0_wp, 4.0_wp, 2.0_wp, 4.0_wp], 6.0_wp/pi)
    associate (v => made%values)
      call expect_close(v(1), 11.0_wp, 1.0e-14_wp, 'audit: real particles')
      call expect_close(v(2), 51.0_wp, 1.0e-14_wp, 'audit: mass')
      call expect_close(v(3), 15.0_wp/11.0_wp, 1.0e-14_wp, 'audit: number mean')
      call expect_close(v(4), 121.0_wp/51.0_wp, 1.0e-14_wp, 'audit: mass mean')
      call expect_close(v(5), 51.0_wp/25.0_wp, 1.0e-14_wp, 'audit: Sauter mean')
      call expect_close(v(6), 1.0_wp, 1.0e-14_wp, 'audit: d10 by mass')
      call expect_close(v(7), 3.0_wp, 1.0e-14_wp, 'audit: d50 by mass')
      call expect_close(v(8), 3.0_wp, 1.0e-14_wp, 'audit: d90 by mass')
      call expect_close(v(9), 1.0_wp, 1.0e-14_wp, 'audit: d50 by number')
      call expect_close(v(10), 1.0_wp, 1.0e-14_wp, 'audit: smallest')
      call expect_close(v(11), 3.0_wp, 1.0e-14_wp, 'audit: largest')
    end associate
  end subroutine audit_by_hand

  !> The number of particles in a mass is M/(rho pi/6 <d^3>).
  subroutine audit_of_powder()
    type(size_summary_t) :: asked

    asked = summary_asked(beads(), 2500.0_wp, 0.106_wp)
    call expect_close(asked%values(1), 0.106_wp/(2500.0_wp*pi/6*138615681.788_wp*um**3), 1.0e-10_wp, 'particles in 0.106 kg')
    call expect_close(asked%values(5), 542.9633825822_wp*um, 1.0e-10_wp, 'Sauter mean of the powder')
    call expect_close(asked%values(10), 250*um, 1.0e-12_wp, 'smallest particle of the powder')
    asked = summary_asked(beads(), 2500.0_wp, unset)
    call expect(asked%values(1) <= unset, 'no number of particles where no mass is known')
  end subroutine audit_of_powder

  subroutine means_of_a_thousand()
    type(size_distribution_t) :: sizes
    type(size_summary_t) :: asked, made
    real(wp), allocatable :: d(:)
    integer :: i

    sizes = beads()
    asked = summary_asked(sizes, 2500.0_wp, unset)
    do i = 1, size(weightings)
      call draw_number(sizes, weightings(i), 1000, d)
      made = summary_made(d, weightings(i)%weight(d), 2500.0_wp)
      associate (name => trim(names(i))//', 1000 parcels: ')
        call expect_close(made%values(3), asked%values(3), 1.0e-3_wp, name//'number mean')
        call expect_close(made%values(4), asked%values(4), 1.0e-3_wp, name//'mass mean')
        call expect_close(made%values(5), asked%values(5), 1.0e-3_wp, name//'Sauter mean')
        call expect_close(made%values(6), asked%values(6), 2.0e-3_wp, name//'d10 by mass')
        call expect_close(made%values(7), asked%values(7), 2.0e-3_wp, name//'d50 by mass')
        call expect_close(made%values(8), asked%values(8), 2.0e-3_wp, name//'d90 by mass')
        call expect_close(made%values(2)/1000, mean_parcel_mass(sizes, weightings(i), 2500.0_wp), 1.0e-3_wp, &
                          name//'mean mass of a parcel')
        call expect(all(d >= 250*um) .and. all(d <= 800*um), name//'within the limits')
      end associate
    end do
  end subroutine means_of_a_thousand

  !> The trap: SSP parcels drawn from the number distribution carry a powder with the Sauter mean 1/<1/d>.
  subroutine drawing_by_number_is_wrong()
    type(size_distribution_t) :: sizes
    type(size_summary_t) :: right, wrong
    real(wp), allocatable :: d(:)

    sizes = beads()
    call draw_number(sizes, weightings(1), 1000, d)
    wrong = summary_made(d, weightings(2)%weight(d), 2500.0_wp)
    call draw_number(sizes, weightings(2), 1000, d)
    right = summary_made(d, weightings(2)%weight(d), 2500.0_wp)
    call expect_close(wrong%values(5), 1/sizes%moment(-1.0_wp), 1.0e-3_wp, 'SSP drawn by number: Sauter mean of a finer powder')
    call expect(wrong%values(5) < 0.9_wp*right%values(5), 'which SSP drawn by mass is far from')
    call expect_close(right%values(5), sizes%sauter_mean(), 1.0e-4_wp, 'SSP drawn by mass: Sauter mean of the powder')
  end subroutine drawing_by_number_is_wrong

  subroutine mass_to_half_a_parcel()
    type(size_distribution_t) :: sizes
    type(size_summary_t) :: made
    real(wp), allocatable :: d(:)
    real(wp), parameter :: parcels(4) = [1.0_wp, 17.3_wp, 1000.4_wp, 21636.7_wp]
    real(wp) :: each, mass
    integer :: i, k

    sizes = beads()
    do i = 1, size(weightings)
      each = mean_parcel_mass(sizes, weightings(i), 2500.0_wp)
      do k = 1, 4
        mass = each*parcels(k)
        call draw_mass(sizes, weightings(i), 2500.0_wp, mass, d)
        made = summary_made(d, weightings(i)%weight(d), 2500.0_wp)
        call expect(abs(made%values(2) - mass) <= 0.51_wp*each, trim(names(i))//': mass to half a parcel')
      end do
    end do
    each = mean_parcel_mass(sizes, weightings(2), 2500.0_wp)
    call expect_close(each, 2500.0_wp*pi/6*(1552.6_wp*um)**3, 1.0e-12_wp, 'an SSP parcel weighs what its sphere weighs')
    each = mean_parcel_mass(sizes, weightings(1), 2500.0_wp)
    call expect_close(each, 27*2500.0_wp*pi/6*138615681.788_wp*um**3, 1.0e-10_wp, 'a mean SSW parcel weighs W mean particles')
  end subroutine mass_to_half_a_parcel

  !> 60 % of 1 mm and 40 % of 2 mm by number are 15.8 % and 84.2 % by mass: no size between occurs.
  subroutine tables()
    type(powder_settings_t) :: powder
    type(outcome_t) :: outcome
    type(size_distribution_t) :: sizes
    real(wp), allocatable :: d(:)

    powder%distribution = 'number_table'
    powder%sizes = [1.0e-3_wp, 2.0e-3_wp]
    powder%fractions = [0.6_wp, 0.4_wp]
    call new_size_distribution(powder, sizes, outcome)
    call draw_number(sizes, weighting_t(8.0_wp, 1.0_wp, 0.0_wp), 1000, d)
    call expect(count(d < 1.5e-3_wp) == 600, 'two sizes, SSW: parcels by number')
    call draw_number(sizes, weighting_t(1.0_wp, 4.0e-3_wp, 1.0_wp), 1000, d)
    call expect(count(d < 1.5e-3_wp) == 158, 'two sizes, SSP: parcels by mass')
    call expect(all(abs(d - 1.0e-3_wp) <= 0.0_wp .or. abs(d - 2.0e-3_wp) <= 0.0_wp), 'two sizes: no other occurs')
  end subroutine tables

end program test_psd_sampling
