!> Size distributions against closed forms: moments, means, quantiles, limits.
program test_psd
  use check, only: expect, expect_close, finish
  use kinds, only: wp
  use outcome, only: outcome_t
  use powder_settings, only: powder_settings_t
  use quantiles, only: quantiles_t
  use size_distribution, only: size_distribution_t, new_size_distribution
  implicit none

  real(wp), parameter :: um = 1.0e-6_wp

  call one_size()
  call log_normal()
  call log_normal_by_mass()
  call log_normal_with_limits()
  call normal()
  call sieve_table()
  call number_table()
  call refusals()
  call finish()

contains

  function made(powder) result(distribution)
    type(powder_settings_t), intent(in) :: powder
    type(size_distribution_t) :: distribution

    type(outcome_t) :: outcome

    call new_size_distribution(powder, distribution, outcome)
    call expect(.not. outcome%failed(), trim(powder%distribution)//' is accepted')
  end function made

  !> 500 and 125 um, by number, without limits.
  function beads(distribution, basis) result(powder)
    character(len=*), intent(in) :: distribution, basis
    type(powder_settings_t) :: powder

    powder%id = 'beads'
    powder%density = 2500.0_wp
    powder%distribution = distribution
    powder%basis = basis
    powder%mean_diameter = 500*um
    powder%standard_deviation = 125*um
  end function beads

  subroutine one_size()
    type(size_distribution_t) :: sizes
    type(quantiles_t) :: by_mass

    sizes = made(beads('single', 'number'))
    by_mass = sizes%weighted_by(3.0_wp)
    call expect(abs(sizes%number_mean() - 500*um) <= 0.0_wp, 'one size: mean diameter, bit for bit')
    call expect(abs(by_mass%at(0.3_wp) - 500*um) <= 0.0_wp, 'one size: any quantile, bit for bit')
    call expect_close(sizes%sauter_mean(), 500*um, 1.0e-14_wp, 'one size: Sauter mean')
  end subroutine one_size

  !> <d^q> = m^q (1 + c^2)^(q (q-1)/2) with the coefficient of variation c; median m/sqrt(1 + c^2).
  subroutine log_normal()
    real(wp), parameter :: c = 1.0_wp + 0.25_wp**2
    type(size_distribution_t) :: sizes
    type(quantiles_t) :: by_number, by_mass
    integer :: q

    sizes = made(beads('log_normal', 'number'))
    do q = -3, 6
      call expect_close(sizes%moment(real(q, wp)), (500*um)**q*c**(0.5_wp*q*(q - 1)), 1.0e-12_wp, 'log-normal: a moment')
    end do
    call expect_close(sizes%mass_mean(), 500*um*c**3, 1.0e-12_wp, 'log-normal: mass mean')
    call expect_close(sizes%sauter_mean(), 500*um*c**2, 1.0e-12_wp, 'log-normal: Sauter mean')
    by_number = sizes%weighted_by(0.0_wp)
    by_mass = sizes%weighted_by(3.0_wp)
    call expect_close(by_number%at(0.5_wp), 500*um/sqrt(c), 1.0e-7_wp, 'log-normal: median by number')
    call expect_close(by_mass%at(0.5_wp), 500*um*c**2.5_wp, 1.0e-7_wp, 'log-normal: median by mass')
    call expect_close(by_mass%at(0.9_wp), 500*um*c**2.5_wp*exp(1.2815515655446004_wp*sqrt(log(c))), 1.0e-7_wp, &
                      'log-normal: d90 by mass')
    call expect_close(by_mass%share_below(by_mass%at(0.1_wp)), 0.1_wp, 1.0e-12_wp, 'log-normal: quantile and back')
  end subroutine log_normal

  !> The mean by mass is <d^4>/<d^3>, the square by mass <d^5>/<d^3>.
  subroutine log_normal_by_mass()
    type(size_distribution_t) :: sizes

    sizes = made(beads('log_normal', 'mass'))
    call expect_close(sizes%mass_mean(), 500*um, 1.0e-12_wp, 'log-normal by mass: mean')
    call expect_close(sizes%moment(5.0_wp)/sizes%moment(3.0_wp), (500*um)**2 + (125*um)**2, 1.0e-12_wp, &
                      'log-normal by mass: standard deviation')
    call expect_close(sizes%number_mean(), 500*um*(1.0_wp + 0.25_wp**2)**(-3), 1.0e-12_wp, 'log-normal by mass: number mean')
  end subroutine log_normal_by_mass

  !> The bed of glass beads cut to 250-800 um:
  !> <d^q> = exp(q mu + q^2 s^2/2) (P(b - q s) - P(a - q s))/(P(b) - P(a)), P the normal distribution,
  !> a and b the limits as (ln d - mu)/s. D = 1.5526 mm has been published for W = 27 of this powder (MFIX),
  !> which its D^3 = W <d^3> meets, so that there the limits truncate as well and do not collect.
  subroutine log_normal_with_limits()
    type(powder_settings_t) :: powder
    type(size_distribution_t) :: sizes
    type(quantiles_t) :: by_mass
    real(wp) :: mean(4), expected(4)
    integer :: q

    powder = beads('log_normal', 'number')
    powder%minimum_diameter = 250*um
    powder%maximum_diameter = 800*um
    sizes = made(powder)
    do q = 1, 4
      expected(q) = truncated_moment(q)
      call expect_close(sizes%moment(real(q, wp)), expected(q), 1.0e-12_wp, 'log-normal with limits: a moment')
    end do
    mean = [sizes%number_mean(), sizes%mass_mean(), sizes%sauter_mean(), (27*sizes%moment(3.0_wp))**(1.0_wp/3.0_wp)]
    call expect_close(mean(1), 492.7767641887_wp*um, 1.0e-10_wp, 'glass beads: number mean')
    call expect_close(mean(2), 566.8808720873_wp*um, 1.0e-10_wp, 'glass beads: mass mean')
    call expect_close(mean(3), 542.9633825822_wp*um, 1.0e-10_wp, 'glass beads: Sauter mean')
    call expect_close(mean(4), 1552.6_wp*um, 3.0e-5_wp, 'glass beads: diameter of equal parcels for W = 27')
    by_mass = sizes%weighted_by(3.0_wp)
    call expect(abs(by_mass%at(0.0_wp) - 250*um) <= 1.0e-18_wp .and. abs(by_mass%at(1.0_wp) - 800*um) <= 1.0e-18_wp, &
                'quantiles 0 and 1 are the limits')
    call expect_close(by_mass%share_below(500*um), truncated_share(500*um, 3), 1.0e-7_wp, 'glass beads: mass below 500 um')
  end subroutine log_normal_with_limits

  pure function standard(x, q) result(p)
    real(wp), intent(in) :: x  !< diameter [m]
    integer, intent(in) :: q
    real(wp) :: p

    real(wp) :: s

    s = sqrt(log(1.0_wp + 0.25_wp**2))
    p = 0.5_wp*erfc(-((log(x/(500*um)) + 0.5_wp*s**2)/s - q*s)/sqrt(2.0_wp))
  end function standard

  pure function truncated_moment(q) result(moment)
    integer, intent(in) :: q
    real(wp) :: moment

    moment = (500*um)**q*(1.0_wp + 0.25_wp**2)**(0.5_wp*q*(q - 1))*(standard(800*um, q) - standard(250*um, q))/ &
             (standard(800*um, 0) - standard(250*um, 0))
  end function truncated_moment

  pure function truncated_share(x, q) result(share)
    real(wp), intent(in) :: x
    integer, intent(in) :: q
    real(wp) :: share

    share = (standard(x, q) - standard(250*um, q))/(standard(800*um, q) - standard(250*um, q))
  end function truncated_share

  !> <d^2> = m^2 + s^2, <d^3> = m^3 + 3 m s^2; by mass the mean is <d^4>/<d^3>.
  subroutine normal()
    type(powder_settings_t) :: powder
    type(size_distribution_t) :: sizes
    type(quantiles_t) :: by_number

    powder = beads('normal', 'number')
    powder%standard_deviation = 50*um
    sizes = made(powder)
    by_number = sizes%weighted_by(0.0_wp)
    call expect_close(sizes%number_mean(), 500*um, 1.0e-13_wp, 'normal: mean')
    call expect_close(sizes%sauter_mean(), (500.0_wp**3 + 1500*50.0_wp**2)/(500.0_wp**2 + 50.0_wp**2)*um, 1.0e-13_wp, &
                      'normal: Sauter mean')
    call expect_close(by_number%share_below(550*um), 0.8413447460685429_wp, 1.0e-6_wp, 'normal: share below m + s')
    call expect_close(by_number%at(0.9772498680518208_wp), 600*um, 1.0e-6_wp, 'normal: size below which m + 2 s lies')
    powder%basis = 'mass'
    sizes = made(powder)
    call expect_close(sizes%mass_mean(), 500*um, 1.0e-12_wp, 'normal by mass: mean')
    call expect_close(sizes%moment(5.0_wp)/sizes%moment(3.0_wp), (500*um)**2 + (50*um)**2, 1.0e-12_wp, &
                      'normal by mass: standard deviation')
  end subroutine normal

  !> Mass spread evenly over each interval [a,b]: the mean of 1/d is ln(b/a)/(b - a), of 1/d^2 1/(a b), of 1/d^3
  !> (a + b)/(2 a^2 b^2).
  subroutine sieve_table()
    type(powder_settings_t) :: powder
    type(size_distribution_t) :: sizes
    type(quantiles_t) :: by_mass
    real(wp) :: mean(0:3)

    powder%id = 'sand'
    powder%distribution = 'sieve_table'
    powder%sizes = [200*um, 400*um, 500*um, 1000*um]
    powder%fractions = [0.0_wp, 0.3_wp, 0.3_wp, 1.0_wp]
    sizes = made(powder)
    mean(0) = (0.3_wp*300 + 0.7_wp*750)*um
    mean(1) = (0.3_wp*log(2.0_wp)/200 + 0.7_wp*log(2.0_wp)/500)/um
    mean(2) = (0.3_wp/(200.0_wp*400) + 0.7_wp/(500.0_wp*1000))/um**2
    mean(3) = (0.3_wp*600/(2*(200.0_wp*400)**2) + 0.7_wp*1500/(2*(500.0_wp*1000)**2))/um**3
    call expect_close(sizes%mass_mean(), mean(0), 1.0e-11_wp, 'sieve table: mass mean')
    call expect_close(sizes%sauter_mean(), 1/mean(1), 1.0e-11_wp, 'sieve table: Sauter mean')
    call expect_close(sizes%number_mean(), mean(2)/mean(3), 1.0e-11_wp, 'sieve table: number mean')
    by_mass = sizes%weighted_by(3.0_wp)
    call expect_close(by_mass%share_below(300*um), 0.15_wp, 1.0e-9_wp, 'sieve table: mass below the middle of a sieve')
    call expect_close(by_mass%share_below(450*um), 0.3_wp, 1.0e-9_wp, 'sieve table: mass below an empty sieve')
    call expect_close(by_mass%at(0.65_wp), 750*um, 1.0e-9_wp, 'sieve table: a quantile')
    powder%maximum_diameter = 750*um
    sizes = made(powder)
    call expect_close(sizes%mass_mean(), (0.3_wp*300 + 0.35_wp*625)/0.65_wp*um, 1.0e-11_wp, 'sieve table with a limit: mass mean')
  end subroutine sieve_table

  subroutine number_table()
    type(powder_settings_t) :: powder
    type(size_distribution_t) :: sizes
    type(quantiles_t) :: by_number, by_mass

    powder%id = 'mix'
    powder%distribution = 'number_table'
    powder%sizes = [1.0_wp, 2.0_wp, 3.0_wp]*1.0e-3_wp
    powder%fractions = [0.5_wp, 0.3_wp, 0.2_wp]
    sizes = made(powder)
    call expect_close(sizes%number_mean(), 1.7e-3_wp, 1.0e-14_wp, 'number table: number mean')
    call expect_close(sizes%sauter_mean(), (0.5_wp + 2.4_wp + 5.4_wp)/(0.5_wp + 1.2_wp + 1.8_wp)*1.0e-3_wp, 1.0e-14_wp, &
                      'number table: Sauter mean')
    by_number = sizes%weighted_by(0.0_wp)
    by_mass = sizes%weighted_by(3.0_wp)
    call expect(abs(by_number%at(0.79_wp) - 2.0e-3_wp) <= 0.0_wp .and. abs(by_number%at(0.81_wp) - 3.0e-3_wp) <= 0.0_wp, &
                'number table: quantiles are sizes of the table')
    call expect_close(by_mass%share_below(2.5e-3_wp), 2.9_wp/8.3_wp, 1.0e-14_wp, 'number table: share of the mass')
    powder%minimum_diameter = 1.5e-3_wp
    sizes = made(powder)
    call expect_close(sizes%number_mean(), 2.4e-3_wp, 1.0e-14_wp, 'number table with a limit: number mean')
  end subroutine number_table

  subroutine refusals()
    type(powder_settings_t) :: powder

    powder = beads('log_normal', 'number')
    powder%minimum_diameter = 20000*um
    call expect_refusal(powder, 'no particle lies between', 'limits that leave nothing')
    powder = beads('log_normal', 'number')
    powder%mean_diameter = -1.0_wp
    call expect_refusal(powder, 'mean_diameter', 'no mean')
    powder = beads('normal', 'number')
    call expect_refusal(powder, 'minimum_diameter', 'a normal distribution that reaches zero')
    powder = beads('sieve_table', 'number')
    call expect_refusal(powder, 'table', 'no table')
    powder%sizes = [1.0e-3_wp, 2.0e-3_wp]
    powder%fractions = [0.2_wp, 1.0_wp]
    call expect_refusal(powder, 'rise from 0', 'a sieve table that does not begin with 0')
    powder%distribution = 'number_table'
    call expect_refusal(powder, 'together be 1', 'fractions that add up to more than 1')
    powder%distribution = 'gamma'
    call expect_refusal(powder, 'not known', 'an unknown distribution')
  end subroutine refusals

  subroutine expect_refusal(powder, words, name)
    type(powder_settings_t), intent(in) :: powder
    character(len=*), intent(in) :: words, name

    type(size_distribution_t) :: sizes
    type(outcome_t) :: outcome

    call new_size_distribution(powder, sizes, outcome)
    if (outcome%failed()) then
      call expect(index(outcome%message, words) > 0, name//' is refused: '//outcome%message)
    else
      call expect(.false., name//' is refused')
    end if
  end subroutine expect_refusal

end program test_psd
